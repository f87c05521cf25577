// Reads and checks a URDF before any engine uses it.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor {

enum class ShapeKind { kBox, kCylinder, kSphere, kMesh };

// One visual or collision shape of a link or an object.
struct ModelShape {
  ShapeKind kind = ShapeKind::kBox;
  Vector3 size = Vector3::Zero();  // box: x y z; cylinder: radius, length; sphere: radius [m];
                                   // mesh: scale
  std::filesystem::path mesh;      // absolute; empty unless a mesh
  std::string place;               // "file:line" of the <mesh>, for errors; empty unless a mesh
  Pose X_LG;                       // pose in the link's frame (for an ObjectModel: in O)
  std::array<double, 4> color = {0.7, 0.7, 0.7, 1};  // red, green, blue, opacity
};

struct UrdfLink {
  std::string name;
  int line = 0;                       // line in the file
  double mass = 0;                    // [kg]
  Vector3 com = Vector3::Zero();      // centre of mass in L [m]
  Matrix3 inertia = Matrix3::Zero();  // inertia about the centre of mass, axes of L [kg·m²]
  std::vector<ModelShape> visuals, collisions;
};

enum class UrdfJointType { kFixed, kRevolute, kContinuous, kPrismatic };
const char* Name(UrdfJointType type);  // name as written in a URDF

struct UrdfJoint {
  std::string name;
  int line = 0;
  UrdfJointType type = UrdfJointType::kFixed;
  int parent = -1, child = -1;  // indices into links
  Pose X_PJ;  // pose of the joint and of the child link in the parent link, at position 0
  Vector3 axis = Vector3::UnitX();  // unit, in J
  double lower = 0, upper = 0;      // [rad] or [m]; ∓inf for continuous joints
  double velocity = 0;              // limit [rad/s] or [m/s]; +inf: none
  double effort = 0;                // limit [N·m] or [N]; +inf: none
  std::string mimics;               // joint that a mimic joint would follow, see ReadUrdf; "": none
};

// A checked URDF. Links are in the file's order. Joints are depth-first from the root, so parents
// come before children.
struct UrdfModel {
  std::string name;
  std::filesystem::path file;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  int root = -1;     // index into links
  std::string text;  // the checked URDF: with links removed, absolute mesh paths, and without
                     // mimic and planar joints

  std::vector<std::string> LinkNames() const;
  double Mass() const;        // mass of all links [kg]
  double MovingMass() const;  // mass of the links that its joints move [kg]
};

// Reads a URDF and removes `remove_links` with all their descendants.
//
// Throws InputError that names file:line, link or joint, value and remedy for: files over 4 MiB or
// 1000 links, document types and entities, malformed XML, unexpanded xacro, no root or two roots, a
// cycle, duplicate names, unknown parents, numbers that are not finite or absurdly large, negative
// mass, moving links without mass or inertia, inertia that is not positive semidefinite or violates
// the triangle inequality, zero axes, missing limits, lower ≥ upper, shapes without size, missing
// mesh files, mesh paths outside the readable folders (scenario/paths.h), and unsupported joint
// types. `scenario_folder` is the folder of the scenario that refers to the URDF. If `folder` is
// empty, the URDF's own folder is used.
//
// A planar joint becomes two prismatic joints and a continuous one (models/urdf_planar.h).
//
// A mimic joint becomes an independent joint. It is then a degree of freedom that does not follow
// the other joint. Grippers have mimic joints, but the arm's end-effector does not move with these
// joints. If the fingers do not matter, remove the gripper with remove_links.
UrdfModel ReadUrdf(const std::filesystem::path& file,
                   const std::vector<std::string>& remove_links = {},
                   const std::filesystem::path& scenario_folder = {});

// Parses a URDF from text. `name` replaces the file name in errors. Relative mesh paths start at
// `folder`.
UrdfModel ParseUrdf(const std::string& text, const std::string& name,
                    const std::filesystem::path& folder,
                    const std::vector<std::string>& remove_links = {},
                    const std::filesystem::path& scenario_folder = {});

}  // namespace predictor
