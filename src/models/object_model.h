// The carried object: one rigid body, from a URDF or defined inline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "models/urdf.h"
#include "scenario/scenario.h"

namespace predictor {

// A rigid object. The frame O of the object is the frame of the root link, or lies at the geometric
// centre of a primitive.
struct ObjectModel {
  std::string name;
  double mass = 0;                              // [kg]
  Vector3 com = Vector3::Zero();                // centre of mass in O [m]
  Matrix3 inertia = Matrix3::Zero();            // about the centre of mass, axes of O [kg·m²]
  std::vector<ModelShape> visuals, collisions;  // X_LG in O
};

// A point of an object's outline, or, with a radius, each point of the sphere around it.
struct OutlinePoint {
  Vector3 p = Vector3::Zero();  // in O [m]
  double radius = 0;            // [m]
};

// Returns points whose hull contains the object's collision shapes, or its visuals if it has no
// collision shape: the corners of each box, the ends of each cylinder's axis with the cylinder's
// radius, and the centre of each sphere with its radius. Meshes are left out.
std::vector<OutlinePoint> OutlineOf(const ObjectModel& object);

// The largest total number of triangles in all collision meshes of an object. At start-up, the
// physics engine computes the convex hull of each mesh. In the worst case (every vertex on the
// hull), this computation takes 0.7 s for the permitted number of triangles, and 4 s for 100 000
// triangles.
inline constexpr std::size_t kMaxCollisionTriangles = 20000;

// Reads an object's URDF. The URDF has one link, or several links that are connected by fixed
// joints. These links are merged into one. Throws InputError if ReadUrdf does, if a joint is
// movable, if mass or inertia is missing, or if there are too many triangles.
ObjectModel ReadObject(const std::filesystem::path& file);
ObjectModel MakeObject(const UrdfModel& urdf);

// Makes an object from a shape of uniform density, unless an inertia is given. Throws InputError if
// size, mass or inertia is impossible. `key` is the scenario's key, which error messages name.
ObjectModel MakeObject(const PrimitiveSpec& primitive, const std::string& key = "object");

// Loads the URDF or the primitive, whichever `spec` contains. `folder` is the scenario's folder.
ObjectModel LoadObject(const ObjectSpec& spec, const std::filesystem::path& folder,
                       const std::string& key = "object");

// Returns the pose X_OD of an existing handle. If the scenario gives it relative to a link
// (handles.*.link), this function reads the object's URDF. Throws InputError at this key if the
// URDF has no such link.
Pose HandlePose(const Scenario& scenario, int hand);

}  // namespace predictor
