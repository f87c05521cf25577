// The virtual scene of a scenario as one tree of links: cobot, attachment, object, handles, floor
// and table.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "models/urdf.h"
#include "scenario/scenario.h"

namespace predictor {

// Mass [kg] and principal moments [kg·m²] of links that have none, or only join others: URDF has no
// joint of three axes, and between three joints of one axis stand two links. MuJoCo and our own
// reader refuse a moving link without mass; Unity's URDF-Importer makes it 0.1 kg, and 1 kg without
// <inertial>. These values all of them take, and 1e-9 of any sum stays right.
inline constexpr double kTinyMass = 1e-10;
inline constexpr double kTinyInertia = 1e-11;

// What is seen or touched of a link.
struct SceneShape {
  ModelShape shape;
  bool has_color = true;          // else a mesh shows its own
  std::filesystem::path texture;  // of its material, instead of the colour; empty if none
};

struct SceneLink {
  std::string name;
  double mass = 0;                    // [kg]; 0: no inertial at all, for what does not move
  Vector3 com = Vector3::Zero();      // in L [m]
  Matrix3 inertia = Matrix3::Zero();  // about the centre of mass, axes of L [kg·m²]
  std::vector<SceneShape> visuals, collisions;
};

struct SceneJoint {
  std::string name, parent, child;  // parent and child: links
  UrdfJointType type = UrdfJointType::kFixed;
  Pose X_PJ;                        // of the joint and the child link, in the parent at position 0
  Vector3 axis = Vector3::UnitX();  // unit, in J
  double lower = 0, upper = 0;      // [rad] or [m]; ∓inf for continuous joints
  double velocity = 0;              // limit [rad/s] or [m/s]; +inf if none
  double effort = 0;                // limit [N·m] or [N]; +inf if none
  double damping = 0;               // viscous [N·m·s/rad] or [N·s/m]
  double friction = 0;              // Coulomb [N·m] or [N]
};

// Parents come before children; the first link is the root, "world".
struct SceneTree {
  std::vector<SceneLink> links;
  std::vector<SceneJoint> joints;
  std::vector<std::string> cobot_joints;       // that move, in RobotModel's order
  std::vector<std::string> attachment_joints;  // that move, from the cobot to the object
  std::string end_effector;                    // link
};

// The cobot's links and joints keep their names, but a link that is called like one of the scene's
// own ("world", "floor", "table", "object", "left_handle", "right_handle", "attachment…_link")
// has "cobot_" put in front. A spherical attachment becomes three continuous joints about x, then
// y, then z of A; the object's frame is O, the handles' D. Throws InputError as loading the models
// does, and if a list has not one value a joint.
SceneTree ComposeTree(const Scenario& scenario);

}  // namespace predictor
