#include "simulation/mujoco/collision_mesh.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "models/object_model.h"
#include "process/sandboxed_call.h"
#include "simulation/mujoco/library.h"

namespace predictor {
namespace {

// The child's answer contains the numbers of vertices and triangles, followed by the data in the
// memory layout of CollisionMesh.
struct Header {
  std::uint32_t vertices, faces;
};
constexpr std::size_t kMaxVertices = 3 * kMaxCollisionTriangles;
constexpr std::size_t kMaxBytes =
    sizeof(Header) + 3 * (kMaxVertices * sizeof(float) + kMaxCollisionTriangles * sizeof(int));
constexpr double kMaxReadTime = 20;  // [s]
constexpr double kFlat = 1e-6;       // thickness of a flat mesh, in parts of its length

void Append(const void* data, std::size_t size, std::vector<std::byte>* to) {
  const auto* bytes = static_cast<const std::byte*>(data);
  to->insert(to->end(), bytes, bytes + size);
}

// Runs in the child. Compiles a model that contains only this mesh, as a visual shape, so that no
// hull is computed. The engine moves a mesh's vertices to its centre and principal axes, which this
// function undoes.
std::vector<std::byte> ReadByEngine(const std::filesystem::path& file) {
  const SpecPtr spec(mj_makeSpec());
  spec->compiler.usethread = 0;
  mjsMesh* mesh = mjs_addMesh(spec.get(), nullptr);
  mjs_setName(mesh->element, "mesh");
  mjs_setString(mesh->file, file.c_str());
  mesh->inertia = mjMESH_INERTIA_SHELL;
  mjsGeom* geom = mjs_addGeom(mjs_findBody(spec.get(), "world"), nullptr);
  geom->type = mjGEOM_MESH;
  geom->contype = geom->conaffinity = 0;
  mjs_setString(geom->meshname, "mesh");
  const ModelPtr model(mj_compile(spec.get(), nullptr));
  if (model == nullptr) throw std::runtime_error(FirstLine(spec.get()));
  const Header header = {static_cast<std::uint32_t>(model->nmeshvert),
                         static_cast<std::uint32_t>(model->nmeshface)};
  if (header.vertices > kMaxVertices || header.faces > kMaxCollisionTriangles)
    throw std::runtime_error("it has more than " + std::to_string(kMaxCollisionTriangles) +
                             " triangles");
  std::vector<std::byte> bytes;
  Append(&header, sizeof header, &bytes);
  for (std::uint32_t i = 0; i < header.vertices; ++i) {
    const float* v = model->mesh_vert + 3 * i;
    const mjtNum centred[3] = {v[0], v[1], v[2]};
    mjtNum p[3];
    mju_rotVecQuat(p, centred, model->mesh_quat);
    mju_addTo3(p, model->mesh_pos);
    const float original[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                               static_cast<float>(p[2])};
    Append(original, sizeof original, &bytes);
  }
  Append(model->mesh_face, 3 * header.faces * sizeof(int), &bytes);
  return bytes;
}

// Runs in the parent. Throws SandboxedFailure if the answer is not a valid mesh.
CollisionMesh Checked(const std::vector<std::byte>& bytes) {
  const SandboxedFailure wrong("its reader did not return a mesh");
  Header header;
  if (bytes.size() < sizeof header) throw wrong;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.vertices > kMaxVertices || header.faces > kMaxCollisionTriangles) throw wrong;
  CollisionMesh mesh;
  mesh.vertices.resize(3 * std::size_t{header.vertices});
  mesh.faces.resize(3 * std::size_t{header.faces});
  const std::size_t vertex_bytes = mesh.vertices.size() * sizeof(float);
  const std::size_t face_bytes = mesh.faces.size() * sizeof(int);
  if (bytes.size() != sizeof header + vertex_bytes + face_bytes) throw wrong;
  std::memcpy(mesh.vertices.data(), bytes.data() + sizeof header, vertex_bytes);
  std::memcpy(mesh.faces.data(), bytes.data() + sizeof header + vertex_bytes, face_bytes);
  const auto is_vertex = [&](int i) {
    return i >= 0 && static_cast<std::uint32_t>(i) < header.vertices;
  };
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                   [](float x) { return std::isfinite(x); }) ||
      !std::all_of(mesh.faces.begin(), mesh.faces.end(), is_vertex))
    throw wrong;
  return mesh;
}

// Returns whether all vertices are in one plane.
bool IsFlat(const CollisionMesh& mesh) {
  if (mesh.vertices.empty()) return true;
  const auto count = static_cast<Eigen::Index>(mesh.vertices.size() / 3);
  const Eigen::Map<const Eigen::Matrix3Xf> points(mesh.vertices.data(), 3, count);
  const Eigen::Matrix3Xd centred =
      points.cast<double>().colwise() - Vector3(points.cast<double>().rowwise().mean());
  const Matrix3 spread = centred * centred.transpose();
  const Vector3 squares = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvalues();
  return squares[0] <= kFlat * kFlat * squares[2];
}

}  // namespace

CollisionMesh ReadCollisionMesh(const ModelShape& shape, const std::string& key) {
  SilenceMujoco();
  try {
    CollisionMesh mesh = Checked(CallSandboxed({shape.mesh}, {kMaxBytes, kMaxReadTime},
                                               [&] { return ReadByEngine(shape.mesh); }));
    if (IsFlat(mesh)) throw SandboxedFailure("it is flat, so its hull has no volume");
    return mesh;
  } catch (const SandboxedFailure& failure) {
    throw InputError::At(key, key + ": " + shape.place + ": The mesh " + shape.mesh.string() +
                                  " cannot be used: " + failure.what() +
                                  ". Repair it, save it as binary STL or OBJ, or give <collision> "
                                  "a box, cylinder or sphere.");
  }
}

}  // namespace predictor
