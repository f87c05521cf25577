// The carried object: one rigid body, from a URDF or defined inline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "models/urdf.h"
#include "scenario/scenario.h"

namespace predictor {

// A rigid object. Its frame O is the frame of the root link or the geometric centre of a primitive.
struct ObjectModel {
  std::string name;
  double mass = 0;                              // [kg]
  Vector3 com = Vector3::Zero();                // centre of mass in O [m]
  Matrix3 inertia = Matrix3::Zero();            // about the centre of mass, axes of O [kg·m²]
  std::vector<ModelShape> visuals, collisions;  // X_LG in O
};

// The limit for all collision meshes of an object together. At start-up, the physics engine
// computes the convex hull of each mesh. In the worst case (every vertex on the hull), this takes
// 0.7 s for this number of triangles and 4 s for 100 000.
inline constexpr std::size_t kMaxCollisionTriangles = 20000;

// Reads an object's URDF. It has one link, or several that are connected by fixed joints and
// merged. Throws InputError if ReadUrdf does, if a joint is movable, if mass or inertia is missing,
// or if there are too many triangles.
ObjectModel ReadObject(const std::filesystem::path& file);
ObjectModel MakeObject(const UrdfModel& urdf);

// Makes an object from a shape of uniform density, unless an inertia is given. Throws InputError if
// size, mass or inertia is impossible. `key`: of the scenario, for errors.
ObjectModel MakeObject(const PrimitiveSpec& primitive, const std::string& key = "object");

// Loads the URDF or the primitive, whichever `spec` contains. `folder` is the scenario's folder.
ObjectModel LoadObject(const ObjectSpec& spec, const std::filesystem::path& folder,
                       const std::string& key = "object");

}  // namespace predictor
