#include "simulation/mujoco/mesh_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "core/error.h"
#include "simulation/collision_hull.h"
#include "simulation/mujoco/library.h"

namespace predictor {
namespace {

using Cell = std::array<std::int64_t, 3>;
using Points = Eigen::Map<const Eigen::Matrix3Xf>;

constexpr double kWeld = 1e-5;  // distance of vertices that count as one, in parts of the diagonal

Points PointsOf(const CollisionMesh& mesh) {
  return {mesh.vertices.data(), 3, static_cast<Eigen::Index>(mesh.vertices.size() / 3)};
}

// For each vertex, the index of the first vertex at the same place, because STL files repeat
// vertices, some of them rounded. The cells of a grid hold the vertices to compare.
std::vector<int> Welded(const CollisionMesh& mesh) {
  const Points points = PointsOf(mesh);
  std::vector<int> same(static_cast<std::size_t>(points.cols()));
  if (same.empty()) return same;
  const Eigen::Vector3f lowest = points.rowwise().minCoeff();
  const double size = (points.rowwise().maxCoeff() - lowest).norm();
  const double near = std::max(kWeld * size, std::numeric_limits<double>::min());
  std::map<Cell, std::vector<int>> first;
  for (int i = 0; i < points.cols(); ++i) {
    Cell cell;
    for (int c = 0; c < 3; ++c)
      cell[static_cast<std::size_t>(c)] =
          static_cast<std::int64_t>((points(c, i) - lowest[c]) / near);
    int found = i;
    for (int n = 0; n < 27 && found == i; ++n) {
      const auto around =
          first.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (around == first.end()) continue;
      for (const int other : around->second)
        if ((points.col(other) - points.col(i)).cast<double>().norm() <= near) found = other;
    }
    if (found == i) first[cell].push_back(i);
    same[static_cast<std::size_t>(i)] = found;
  }
  return same;
}

// Returns the triangles with welded vertices, without those that have no area left.
std::vector<std::array<int, 3>> Triangles(const CollisionMesh& mesh, const std::vector<int>& same) {
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t f = 0; f + 2 < mesh.faces.size(); f += 3) {
    std::array<int, 3> corner;
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = same[static_cast<std::size_t>(mesh.faces[f + i])];
    if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0])
      triangles.push_back(corner);
  }
  return triangles;
}

// Returns the volume of the convex hull, or 0 if the engine cannot compute the hull.
double HullVolume(const CollisionMesh& from) {
  const SpecPtr spec(mj_makeSpec());
  mjsMesh* mesh = mjs_addMesh(spec.get(), nullptr);
  mjs_setName(mesh->element, "mesh");
  mjs_setFloat(mesh->uservert, from.vertices.data(), static_cast<int>(from.vertices.size()));
  mjs_setInt(mesh->userface, from.faces.data(), static_cast<int>(from.faces.size()));
  mesh->inertia = mjMESH_INERTIA_CONVEX;
  mjsBody* body = mjs_addBody(mjs_findBody(spec.get(), "world"), nullptr);
  mjsGeom* geom = mjs_addGeom(body, nullptr);
  geom->type = mjGEOM_MESH;
  geom->density = 1;
  mjs_setString(geom->meshname, "mesh");
  const ModelPtr model(mj_compile(spec.get(), nullptr));
  return model ? model->body_mass[1] : 0;
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
  std::vector<bool> used(same.size(), false);
  const std::vector<std::array<int, 3>> triangles = Triangles(mesh, same);
  for (const std::array<int, 3>& corner : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = corner[i], b = corner[(i + 1) % 3];
      ++edges[std::minmax(a, b)];
      parts.Join(a, b);
      used[static_cast<std::size_t>(a)] = true;
    }
  std::map<int, Count> counts;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) ++counts[parts.Of(static_cast<int>(i))].vertices;
  for (const std::array<int, 3>& corner : triangles) ++counts[parts.Of(corner[0])].faces;
  for (const auto& [edge, sides] : edges) {
    Count& count = counts[parts.Of(edge.first)];
    ++count.edges;
    count.closed = count.closed && sides == 2;
  }
  int holes = 0;
  for (const auto& [part, count] : counts)
    if (count.closed) holes += (2 - (count.vertices - count.edges + count.faces)) / 2;
  return holes;
}

double HullExcess(const CollisionMesh& mesh) {
  const Points points = PointsOf(mesh);
  if (points.cols() == 0) return 1;
  const Vector3 middle = points.cast<double>().rowwise().mean();
  const auto from_middle = [&](int i) { return Vector3(points.col(i).cast<double>() - middle); };
  std::set<std::pair<int, int>> edges;
  double volume = 0;
  for (const auto& [a, b, c] : Triangles(mesh, Welded(mesh))) {
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (!edges.insert(edge).second) return 1;
    volume += from_middle(a).dot(from_middle(b).cross(from_middle(c))) / 6;
  }
  const double hull = HullVolume(mesh);
  return volume == 0 || hull == 0 ? 1 : hull / std::fabs(volume);
}

double HullExcess(const ModelShape& shape, const std::string& key) {
  return shape.kind == ShapeKind::kMesh ? HullExcess(ReadCollisionMesh(shape, key)) : 1;
}

void CheckHull(const ModelShape& shape, const std::string& key) {
  if (shape.kind != ShapeKind::kMesh) return;
  const int holes = ThroughHoles(ReadCollisionMesh(shape, key));
  if (holes == 0) return;
  throw InputError::At(
      key, key + ": " + shape.place + ": The mesh " + shape.mesh.string() + " has " +
               (holes == 1 ? "a hole" : std::to_string(holes) + " holes") +
               " through it, but its convex hull collides instead of the mesh and would fill " +
               (holes == 1 ? "it" : "them") +
               ". Build the part around the hole from several <collision> boxes and cylinders.");
}

}  // namespace predictor
