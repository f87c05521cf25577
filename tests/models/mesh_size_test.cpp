// If collision meshes would delay the start too much, the program must refuse them before the
// engine reads them.
#include "models/mesh_size.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "models/object_model.h"
#include "support/temporary_folder.h"

namespace predictor::test {
namespace {

namespace fs = std::filesystem;

class MeshSize : public testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  static std::string Binary(const std::vector<std::uint32_t>& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), sizeof(std::uint32_t) * numbers.size()};
  }
  fs::path WriteStl(const std::string& name, std::uint32_t triangles) const {
    return Write(name,
                 std::string(80, ' ') + Binary({triangles}) + std::string(50 * triangles, '\0'));
  }

  // Reads an object whose link contains these elements. Returns the error message, or "" if there
  // is no error.
  std::string ErrorOf(const std::string& shapes) const {
    const fs::path file =
        Write("object.urdf",
              "<robot name=\"o\"><link name=\"o\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" "
              "iyy=\"1\" izz=\"1\"/></inertial>\n" +
                  shapes + "</link></robot>");
    try {
      ReadObject(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static std::string Collision(const std::string& mesh) {
    return "<collision><geometry>\n<mesh filename=\"" + mesh + "\"/></geometry></collision>\n";
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(MeshSize, IsCountedInTheFormsThatTheEngineReads) {
  EXPECT_EQ(CountTriangles(WriteStl("a.stl", 7)), 7u);
  EXPECT_EQ(CountTriangles(WriteStl("A.STL", 8)), 8u);
  EXPECT_EQ(CountTriangles(Write("a.obj",
                                 "# f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                 "f 1 2 3\nf 1//1 2//1  3//1 4//1 \r\n")),
            3u);
  EXPECT_EQ(CountTriangles(Write("a.msh", Binary({4, 0, 0, 5}) + std::string(12 * (4 + 5), ' '))),
            5u);
}

TEST_F(MeshSize, OfACloudIsAThirdOfItsPoints) {
  std::string points;
  for (int i = 0; i < 30; ++i) points += "v 0 0 0\n";
  EXPECT_EQ(CountTriangles(Write("cloud.obj", points)), 10u);
  EXPECT_EQ(CountTriangles(Write("cloud.msh", Binary({60, 0, 0, 1}) + std::string(12 * 61, ' '))),
            20u);
}

TEST_F(MeshSize, OfATruncatedOrUnknownFileIsZero) {
  for (const char* name : {"cut.stl", "cut.msh", "cut.obj", "other.dae"})
    EXPECT_EQ(CountTriangles(Write(name, "x")), 0u) << name;
  const std::string text = "solid text\n" + std::string(200, ' ');
  EXPECT_EQ(CountTriangles(Write("text.stl", text)), 0u);
  EXPECT_EQ(CountTriangles(Write("text.msh", text)), 0u);
}

TEST_F(MeshSize, TooLargeIsRefusedWhereItIsNamed) {
  WriteStl("large.stl", kMaxCollisionTriangles + 1);
  const std::string error = ErrorOf(Collision("large.stl"));
  EXPECT_EQ(error.rfind((folder_ / "object.urdf").string() + ":3: ", 0), 0u) << error;
  EXPECT_NE(error.find((folder_ / "large.stl").string()), std::string::npos) << error;
  EXPECT_NE(error.find("20001 triangles, but at most 20000 are possible. Simplify"),
            std::string::npos)
      << error;
}

TEST_F(MeshSize, IsLimitedForAllOfAnObjectTogether) {
  WriteStl("half.stl", kMaxCollisionTriangles / 2);
  EXPECT_EQ(ErrorOf(Collision("half.stl") + Collision("half.stl")), "");
  WriteStl("one.stl", 1);
  const std::string error =
      ErrorOf(Collision("half.stl") + Collision("half.stl") + Collision("one.stl"));
  EXPECT_NE(error.find("object.urdf:7: "), std::string::npos) << error;
}

TEST_F(MeshSize, OfVisualMeshesIsUnlimited) {
  WriteStl("large.stl", kMaxCollisionTriangles + 1);
  EXPECT_EQ(ErrorOf("<visual><geometry><mesh filename=\"large.stl\"/></geometry></visual>"), "");
}

}  // namespace
}  // namespace predictor::test
