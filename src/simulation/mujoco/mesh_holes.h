// Finds holes and recesses in a mesh, which the mesh's convex hull would fill.
#pragma once

#include <string>

#include "models/urdf.h"
#include "simulation/mujoco/collision_mesh.h"

namespace predictor {

// Returns the number of holes through a mesh. This is the sum of the genus g of its closed parts,
// which follows from Euler's formula V − E + F = 2 − 2 g for each part. Parts with an open edge, or
// with an edge that belongs to more than two triangles, are treated as if they had no hole. A hole
// that does not go through the mesh is not counted. Vertices nearer to each other than 1e-5 of the
// mesh's diagonal are treated as one vertex.
int ThroughHoles(const CollisionMesh& mesh);

// Returns what simulation/collision_hull.h describes, for a mesh that has been read.
double HullExcess(const CollisionMesh& mesh);

// Throws InputError if the shape is a mesh with a hole through it. `key`: of the scenario.
void CheckHull(const ModelShape& shape, const std::string& key);

}  // namespace predictor
