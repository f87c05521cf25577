#include "simulation/mujoco/collision_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

// A tetrahedron that is neither centred nor aligned with its principal axes.
constexpr const char* kTetrahedron =
    "v 1 2 3\nv 1.5 2 3\nv 1 2.25 3\nv 1 2 4\n"
    "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class CollisionMeshTest : public testing::Test {
 protected:
  ModelShape Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
    ModelShape shape;
    shape.kind = ShapeKind::kMesh;
    shape.mesh = folder_.path() / name;
    shape.place = "box.urdf:4";
    shape.size = Vector3(2, 2, 2);
    return shape;
  }
  std::string ErrorOf(const ModelShape& shape) const {
    try {
      ReadCollisionMesh(shape, "object.model");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  const test::TemporaryFolder folder_;
};

TEST_F(CollisionMeshTest, GivesTheFilesOwnCoordinatesWithoutTheScale) {
  const CollisionMesh mesh = ReadCollisionMesh(Write("a.obj", kTetrahedron), "object.model");
  ASSERT_EQ(mesh.vertices.size(), 12u);
  ASSERT_EQ(mesh.faces.size(), 12u);
  const std::array<Vector3, 4> corners = {Vector3(1, 2, 3), Vector3(1.5, 2, 3), Vector3(1, 2.25, 3),
                                          Vector3(1, 2, 4)};
  std::set<std::size_t> found;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 p(mesh.vertices[3 * i], mesh.vertices[3 * i + 1], mesh.vertices[3 * i + 2]);
    for (std::size_t c = 0; c < 4; ++c)
      if ((p - corners[c]).norm() < 1e-6) found.insert(c);
  }
  EXPECT_EQ(found.size(), 4u);
}

TEST_F(CollisionMeshTest, AnInvalidMeshIsAnErrorWithPlaceAndRemedy) {
  const std::string error = ErrorOf(Write("a.stl", "solid nothing"));
  EXPECT_EQ(error.find("object.model: box.urdf:4: The mesh "), 0u) << error;
  EXPECT_NE(error.find("a.stl cannot be used: "), std::string::npos) << error;
  EXPECT_NE(error.find("Repair it"), std::string::npos) << error;
}

TEST_F(CollisionMeshTest, AMeshWithoutVolumeIsAnError) {
  std::string text = kTetrahedron;
  text.replace(text.find("v 1 2 4"), 7, "v 2 3 3");  // all four in the plane z = 3
  const std::string error = ErrorOf(Write("a.obj", text));
  EXPECT_EQ(error.find("object.model: box.urdf:4: The mesh "), 0u) << error;
  EXPECT_NE(error.find("it is flat, so its hull has no volume"), std::string::npos) << error;
  EXPECT_NE(error.find("give <collision> a box, cylinder or sphere"), std::string::npos) << error;
}

TEST_F(CollisionMeshTest, NumbersThatAreNotFiniteAreAnError) {
  std::string text = kTetrahedron;
  text.replace(text.find("1.5"), 3, "nan");
  EXPECT_NE(ErrorOf(Write("a.obj", text)), "");
}

}  // namespace
}  // namespace predictor
