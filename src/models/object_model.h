// What is carried: one rigid body, out of a URDF or given inline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "models/urdf.h"
#include "scenario/scenario.h"

namespace predictor {

// A rigid object; its frame O is the root link's (of a primitive: its geometric centre).
struct ObjectModel {
  std::string name;
  double mass = 0;                              // [kg]
  Vector3 com = Vector3::Zero();                // in O [m]
  Matrix3 inertia = Matrix3::Zero();            // about the centre of mass, axes of O [kg·m²]
  std::vector<ModelShape> visuals, collisions;  // X_LG in O
};

// Of an object's collision meshes together. The physics engine takes the convex hull of each at the
// start: in the worst case (each corner on the hull) 0.7 s for so many, and 4 s for 100 000.
inline constexpr std::size_t kMostCollisionTriangles = 20000;

// Reads an object's URDF: one link, or several by fixed joints, which are merged. Throws InputError
// as ReadUrdf does, and if a joint moves, there is no mass or inertia, or too many triangles.
ObjectModel ReadObject(const std::filesystem::path& file);
ObjectModel MakeObject(const UrdfModel& urdf);

// Out of a shape of uniform density, unless an inertia is given. Throws InputError if size, mass or
// inertia cannot be.
ObjectModel MakeObject(const PrimitiveSpec& primitive);

// Whichever of the two `spec` names; `folder` is the scenario's.
ObjectModel LoadObject(const ObjectSpec& spec, const std::filesystem::path& folder);

}  // namespace predictor
