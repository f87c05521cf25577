#include "simulation/mujoco/mesh_holes.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>
#include <utility>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

// Adds the two triangles of a quadrilateral.
void AddQuadrilateral(const std::array<int, 4>& corner, CollisionMesh* mesh) {
  for (const int i : {0, 1, 2, 0, 2, 3}) mesh->faces.push_back(corner[static_cast<std::size_t>(i)]);
}

// Adds a square frame around an axis parallel to z. The frame has four rings of four corners each.
// One outer and one inner ring are below, and one outer and one inner ring are above. `x` is the
// position of the frame's centre.
void AddFrame(float x, CollisionMesh* mesh) {
  const int first = static_cast<int>(mesh->vertices.size() / 3);
  for (const float z : {0.0F, 0.1F})
    for (const float r : {1.0F, 0.5F})
      for (const auto& [u, v] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}})
        for (const float c : {x + r * static_cast<float>(u), r * static_cast<float>(v), z})
          mesh->vertices.push_back(c);
  const int below = first, above = first + 8;  // outer; the inner ones follow 4 later
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    AddQuadrilateral({below + i, below + j, above + j, above + i}, mesh);
    AddQuadrilateral({below + 4 + j, below + 4 + i, above + 4 + i, above + 4 + j}, mesh);
    AddQuadrilateral({above + i, above + j, above + 4 + j, above + 4 + i}, mesh);
    AddQuadrilateral({below + j, below + i, below + 4 + i, below + 4 + j}, mesh);
  }
}

// Returns the same surface, but each triangle has three vertices of its own.
CollisionMesh WithRepeatedVertices(const CollisionMesh& mesh) {
  CollisionMesh repeated;
  for (const int v : mesh.faces) {
    repeated.faces.push_back(static_cast<int>(repeated.faces.size()));
    for (int c = 0; c < 3; ++c)
      repeated.vertices.push_back(mesh.vertices[static_cast<std::size_t>(3 * v + c)]);
  }
  return repeated;
}

CollisionMesh Tetrahedron() {
  return {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}};
}

TEST(MeshHoles, FollowFromEulersFormula) {
  EXPECT_EQ(ThroughHoles(Tetrahedron()), 0);
  CollisionMesh mesh;
  AddFrame(0, &mesh);
  EXPECT_EQ(ThroughHoles(mesh), 1);
  EXPECT_EQ(ThroughHoles(WithRepeatedVertices(mesh)), 1);
  AddFrame(3, &mesh);
  EXPECT_EQ(ThroughHoles(mesh), 2);
  EXPECT_EQ(ThroughHoles(WithRepeatedVertices(mesh)), 2);
}

// STL files repeat each vertex, and some programs round the copies differently.
TEST(MeshHoles, VerticesThatDifferByARoundingErrorAreOne) {
  CollisionMesh frame;
  AddFrame(0, &frame);
  for (const auto& [error, holes] : {std::pair{1e-6F, 1}, {1e-3F, 0}}) {
    CollisionMesh mesh = WithRepeatedVertices(frame);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      mesh.vertices[i] += error * static_cast<float>(i * 7 % 5) / 4;  // differs between copies
    EXPECT_EQ(ThroughHoles(mesh), holes) << error;
  }
}

// The outer box of the frame has the volume 2 · 2 · 0.1, and its hole the volume 1 · 1 · 0.1.
TEST(MeshHoles, TheHullsExcessIsTheVolumeOfHolesAndRecesses) {
  EXPECT_NEAR(HullExcess(Tetrahedron()), 1, 1e-6);
  CollisionMesh mesh;
  AddFrame(0, &mesh);
  EXPECT_NEAR(HullExcess(mesh), 4.0 / 3, 1e-5);
  EXPECT_NEAR(HullExcess(WithRepeatedVertices(mesh)), 4.0 / 3, 1e-5);
  std::swap(mesh.faces[0], mesh.faces[1]);  // one triangle faces inwards
  EXPECT_EQ(HullExcess(mesh), 1);
}

// A bottom closes the hole of the frame at z = 0, so the mesh has a recess instead of a hole.
TEST(MeshHoles, ARecessIsNotAHoleButTheHullFillsIt) {
  CollisionMesh cup;
  AddFrame(0, &cup);
  // The bottom of the frame becomes a plate with the four outer corners only.
  CollisionMesh with_bottom{cup.vertices, {}};
  for (std::size_t f = 0; f < cup.faces.size(); f += 3) {
    const auto is_low = [&](std::size_t i) {
      return cup.vertices[static_cast<std::size_t>(3 * cup.faces[f + i] + 2)] == 0;
    };
    if (is_low(0) && is_low(1) && is_low(2)) continue;
    for (std::size_t i = 0; i < 3; ++i) with_bottom.faces.push_back(cup.faces[f + i]);
  }
  AddQuadrilateral({3, 2, 1, 0}, &with_bottom);  // the outer face of the bottom
  // The inner ring at z = 0 is lifted to the inner face of the bottom.
  for (int v = 4; v < 8; ++v) with_bottom.vertices[static_cast<std::size_t>(3 * v + 2)] = 0.02F;
  AddQuadrilateral({4, 5, 6, 7}, &with_bottom);
  EXPECT_EQ(ThroughHoles(with_bottom), 0);
  EXPECT_NEAR(HullExcess(with_bottom), 0.4 / (0.4 - 0.08), 1e-5);
}

TEST(MeshHoles, AnOpenSurfaceCountsAsWithout) {
  CollisionMesh mesh;
  AddFrame(0, &mesh);
  mesh.faces.resize(mesh.faces.size() - 3);
  EXPECT_EQ(ThroughHoles(mesh), 0);
  AddFrame(3, &mesh);
  EXPECT_EQ(ThroughHoles(mesh), 1);
}

TEST(MeshHoles, OneThatAHullWouldFillIsAnErrorWithPlaceAndRemedy) {
  const test::TemporaryFolder folder;
  CollisionMesh mesh;
  AddFrame(0, &mesh);
  ModelShape shape;
  shape.kind = ShapeKind::kMesh;
  shape.mesh = folder.path() / "frame.obj";
  shape.place = "part.urdf:4";
  std::ofstream file(shape.mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 3)
    file << "v " << mesh.vertices[i] << ' ' << mesh.vertices[i + 1] << ' ' << mesh.vertices[i + 2]
         << '\n';
  for (std::size_t i = 0; i < mesh.faces.size(); i += 3)
    file << "f " << mesh.faces[i] + 1 << ' ' << mesh.faces[i + 1] + 1 << ' '
         << mesh.faces[i + 2] + 1 << '\n';
  file.close();
  try {
    CheckHull(shape, "object.model");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(),
              "object.model: part.urdf:4: The mesh " + shape.mesh.string() +
                  " has a hole through it, but its convex hull collides instead of the mesh and "
                  "would fill it. Build the part around the hole from several <collision> boxes "
                  "and cylinders.");
  }
  shape.kind = ShapeKind::kBox;
  EXPECT_NO_THROW(CheckHull(shape, "object.model"));
}

}  // namespace
}  // namespace predictor
