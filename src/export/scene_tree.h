// Represents a scenario's virtual scene as one tree of links (cobot, attachment, object, handles,
// floor, table and fixtures) and as free bodies, which are the movable objects.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "models/urdf.h"
#include "scenario/scenario.h"

namespace predictor::scene_export {

// The mass [kg] and the principal moments of inertia [kg·m²] of links that have no mass or that
// only connect other links. URDF has no joint with three axes, so the ball joint becomes three
// single-axis joints with two links between them. MuJoCo and our own reader refuse a moving link
// without mass. Unity's URDF-Importer would give such a link a mass of 0.1 kg, or of 1 kg if the
// link has no <inertial>. All these programs accept the values given here. Together, the values
// change any sum of masses or moments of inertia by less than 1e-9.
inline constexpr double kTinyMass = 1e-10;
inline constexpr double kTinyInertia = 1e-11;

// A visual or collision shape of a link.
struct SceneShape {
  ModelShape shape;
  bool has_color = true;          // false: the mesh shows its own colours
  std::filesystem::path texture;  // texture of the material, used instead of the colour; may be
                                  // empty
};

struct SceneLink {
  std::string name;
  double mass = 0;                    // [kg]; 0: no inertial element, for links that do not move
  Vector3 com = Vector3::Zero();      // in L [m]
  Matrix3 inertia = Matrix3::Zero();  // about the centre of mass, axes of L [kg·m²]
  std::vector<SceneShape> visuals, collisions;
  std::optional<double> friction;  // friction of a body of the surroundings; empty for other links
};

struct SceneJoint {
  std::string name, parent, child;  // links
  UrdfJointType type = UrdfJointType::kFixed;
  Pose X_PJ;  // pose of the joint and of the child link in the parent, at position 0
  Vector3 axis = Vector3::UnitX();  // unit, in J
  double lower = 0, upper = 0;      // [rad] or [m]; ∓inf for continuous joints
  double velocity = 0;              // limit [rad/s] or [m/s]; +inf: none
  double effort = 0;                // limit [N·m] or [N]; +inf: none
  double damping = 0;               // viscous [N·m·s/rad] or [N·s/m]
  double friction = 0;              // Coulomb [N·m] or [N]
};

// A body that nothing holds.
struct SceneBody {
  SceneLink link;  // its friction is that of its contacts
  Pose X_WL;       // at the start
};

// Parents come before children, and the first link is the root, "world".
struct SceneTree {
  std::vector<SceneLink> links;
  std::vector<SceneJoint> joints;
  std::vector<std::string> cobot_joints;       // moving joints, in RobotModel's order
  std::vector<std::string> attachment_joints;  // moving joints, from the cobot to the object
  std::string end_effector;                    // link
  std::vector<SceneBody> movables;             // named movable_0, movable_1, …
};

// The cobot's links and joints keep their names. Only a link with the name of one of the scene's
// own links ("world", "floor", "table", "object", "left_handle", "right_handle",
// "attachment…_link") gets the prefix "cobot_". A spherical attachment becomes three continuous
// joints about x, y and z of A, in this order. The object's frame is O, and the handles' frames are
// D. Throws InputError if a model cannot be loaded, or if the length of a list differs from the
// number of joints.
SceneTree ComposeTree(const Scenario& scenario);

}  // namespace predictor::scene_export
