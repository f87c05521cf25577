// How much work a mesh file is, found before anything builds it.
#pragma once

#include <cstddef>
#include <filesystem>

namespace predictor {

// Triangles of a mesh in a form that the physics engine reads (binary STL, OBJ, MSH; polygons count
// as the triangles they are cut into), or a third of its vertices if they are more. 0 for other
// forms, and where the file is too short to say.
std::size_t CountTriangles(const std::filesystem::path& mesh);

}  // namespace predictor
