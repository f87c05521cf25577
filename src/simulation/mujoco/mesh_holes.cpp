#include "simulation/mujoco/mesh_holes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "core/error.h"

namespace predictor {
namespace {

using Point = std::array<float, 3>;

// For each vertex, the index of the first vertex at the same place, because STL files repeat
// vertices.
std::vector<int> Welded(const CollisionMesh& mesh) {
  std::map<Point, int> first;
  std::vector<int> same(mesh.vertices.size() / 3);
  for (std::size_t i = 0; i < same.size(); ++i) {
    const float* v = &mesh.vertices[3 * i];
    same[i] = first.emplace(Point{v[0], v[1], v[2]}, static_cast<int>(i)).first->second;
  }
  return same;
}

// The parts of a mesh: sets of vertices that edges connect.
class Parts {
 public:
  explicit Parts(std::size_t vertices) : parent_(vertices) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int Of(int vertex) {
    while (Parent(vertex) != vertex) vertex = Parent(vertex) = Parent(Parent(vertex));
    return vertex;
  }
  void Join(int a, int b) { Parent(Of(a)) = Of(b); }

 private:
  int& Parent(int vertex) { return parent_[static_cast<std::size_t>(vertex)]; }

  std::vector<int> parent_;
};

struct Count {
  int vertices = 0, edges = 0, faces = 0;
  bool closed = true;
};

}  // namespace

int ThroughHoles(const CollisionMesh& mesh) {
  const std::vector<int> same = Welded(mesh);
  Parts parts(same.size());
  std::map<std::pair<int, int>, int> edges;  // with the number of their triangles
  std::vector<int> face_vertex;              // one of each triangle
  std::vector<bool> used(same.size(), false);
  for (std::size_t f = 0; f + 2 < mesh.faces.size(); f += 3) {
    std::array<int, 3> corner;
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = same[static_cast<std::size_t>(mesh.faces[f + i])];
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    face_vertex.push_back(corner[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = corner[i], b = corner[(i + 1) % 3];
      ++edges[std::minmax(a, b)];
      parts.Join(a, b);
      used[static_cast<std::size_t>(a)] = true;
    }
  }
  std::map<int, Count> counts;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) ++counts[parts.Of(static_cast<int>(i))].vertices;
  for (const int vertex : face_vertex) ++counts[parts.Of(vertex)].faces;
  for (const auto& [edge, triangles] : edges) {
    Count& count = counts[parts.Of(edge.first)];
    ++count.edges;
    count.closed = count.closed && triangles == 2;
  }
  int holes = 0;
  for (const auto& [part, count] : counts)
    if (count.closed) holes += (2 - (count.vertices - count.edges + count.faces)) / 2;
  return holes;
}

void CheckHull(const ModelShape& shape, const std::string& key) {
  if (shape.kind != ShapeKind::kMesh) return;
  const int holes = ThroughHoles(ReadCollisionMesh(shape, key));
  if (holes == 0) return;
  throw InputError::At(
      key, key + ": " + shape.place + ": The mesh " + shape.mesh.string() + " has " +
               (holes == 1 ? "a hole" : std::to_string(holes) + " holes") +
               " through it, but its convex hull collides with the fixtures and would fill " +
               (holes == 1 ? "it" : "them") +
               ". Build the part around the hole from several <collision> boxes and cylinders.");
}

}  // namespace predictor
