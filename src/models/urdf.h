// Reading and checking URDF before any engine sees it.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor {

enum class ShapeKind { kBox, kCylinder, kSphere, kMesh };

// What is seen or touched of a link or an object.
struct ModelShape {
  ShapeKind kind = ShapeKind::kBox;
  Vector3 size = Vector3::Zero();  // box: x y z; cylinder: radius, length; sphere: radius [m];
                                   // mesh: scale
  std::filesystem::path mesh;      // absolute; empty but for meshes
  std::string place;               // "file:line" of the <mesh>, for errors; empty but for meshes
  Pose X_LG;                       // in the link (of an ObjectModel: in O)
  std::array<double, 4> color = {0.7, 0.7, 0.7, 1};  // red, green, blue, opacity
};

struct UrdfLink {
  std::string name;
  int line = 0;                       // in the file
  double mass = 0;                    // [kg]
  Vector3 com = Vector3::Zero();      // in L [m]
  Matrix3 inertia = Matrix3::Zero();  // about the centre of mass, axes of L [kg·m²]
  std::vector<ModelShape> visuals, collisions;
};

enum class UrdfJointType { kFixed, kRevolute, kContinuous, kPrismatic };
const char* Name(UrdfJointType type);  // as in a URDF

struct UrdfJoint {
  std::string name;
  int line = 0;
  UrdfJointType type = UrdfJointType::kFixed;
  int parent = -1, child = -1;      // indices into links
  Pose X_PJ;                        // joint (and child link) in the parent link, at position 0
  Vector3 axis = Vector3::UnitX();  // unit, in J
  double lower = 0, upper = 0;      // [rad] or [m]; ∓inf for continuous joints
  double velocity = 0;              // limit [rad/s] or [m/s]; +inf if none
  double effort = 0;                // limit [N·m] or [N]; +inf if none
};

// A URDF that was checked. Links in the file's order, joints depth-first from the root, so that
// parents come before children.
struct UrdfModel {
  std::string name;
  std::filesystem::path file;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  int root = -1;     // index into links
  std::string text;  // the URDF as checked: cut, mesh paths absolute, no mimic

  std::vector<std::string> LinkNames() const;
  double Mass() const;  // of all links [kg]
};

// Reads a URDF, with `remove_links` (and all that hangs on them) cut out.
//
// Refuses, by InputError that names file:line, link or joint, value and what to change: files over
// 4 MiB or 1000 links, document types and entities, malformed XML, unexpanded xacro, no or two
// roots, a cycle, duplicate names, unknown parents, numbers that are not finite or absurdly large,
// negative mass, moving links without mass or inertia, inertia that is not positive semidefinite or
// violates the triangle rule, zero axes, missing limits, lower ≥ upper, shapes without size,
// missing mesh files, mesh paths outside of what may be read (scenario/paths.h), joint types not
// supported. `scenario_folder`: of the scenario that asks for it; if empty, the URDF's own.
//
// A mimic joint becomes an ordinary joint of its own: it counts as a degree of freedom and nothing
// makes it follow the other. (Grippers have them; an arm's end-effector does not move with them.
// Cut the gripper off by remove_links where its fingers do not matter.)
UrdfModel ReadUrdf(const std::filesystem::path& file,
                   const std::vector<std::string>& remove_links = {},
                   const std::filesystem::path& scenario_folder = {});

// The same from text; `name` stands for the file in errors, relative meshes start at `folder`.
UrdfModel ParseUrdf(const std::string& text, const std::string& name,
                    const std::filesystem::path& folder,
                    const std::vector<std::string>& remove_links = {},
                    const std::filesystem::path& scenario_folder = {});

}  // namespace predictor
