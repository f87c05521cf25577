// Reads vertices and triangles of a mesh file in a separate process.
#pragma once

#include <string>
#include <vector>

#include "models/urdf.h"

namespace predictor {

struct CollisionMesh {
  std::vector<float> vertices;  // x, y, z of each vertex as in the file, without the URDF's scale
  std::vector<int> faces;       // three vertex indices of each triangle
};

// Reads the file of a mesh shape (binary STL, OBJ, MSH) with the physics engine's readers. The
// readers run in a sandboxed child. The child's answer must contain finite numbers, at most
// kMaxCollisionTriangles triangles, valid vertex indices, and a volume. `key` is the key of the
// scenario that error messages name. Throws InputError with the place in the URDF, the file, and a
// remedy. Not for the tick.
CollisionMesh ReadCollisionMesh(const ModelShape& shape, const std::string& key);

}  // namespace predictor
