// Measures the size of a mesh file before the mesh is built.
#pragma once

#include <cstddef>
#include <filesystem>

namespace predictor {

// Returns the number of triangles of a mesh after polygons are split into triangles, or one third
// of the number of its vertices if this is larger. The file has a format that the physics engine
// reads (binary STL, OBJ, MSH). Returns 0 for other formats and for truncated files.
std::size_t CountTriangles(const std::filesystem::path& mesh);

}  // namespace predictor
