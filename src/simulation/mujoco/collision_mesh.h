// Reads vertices and triangles of a mesh file in a separate process.
#pragma once

#include <vector>

#include "models/urdf.h"

namespace predictor {

struct CollisionMesh {
  std::vector<float> vertices;  // x, y, z of each vertex as in the file, without the URDF's scale
  std::vector<int> faces;       // three vertex indices of each triangle
};

// Reads the file of a mesh shape (binary STL, OBJ, MSH) with the physics engine's readers. They run
// in a sandboxed child whose answer is checked: finite numbers, at most kMaxCollisionTriangles
// triangles, and valid vertex indices. Throws InputError with the place in the URDF, the file, and
// a remedy. It must not be called in a tick.
CollisionMesh ReadCollisionMesh(const ModelShape& shape);

}  // namespace predictor
