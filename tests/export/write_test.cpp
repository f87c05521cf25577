// Writing a package must not damage existing files at the destination.
#include <gtest/gtest.h>

#include "core/error.h"
#include "export/files.h"
#include "export/scene_package.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;
using Contents = std::map<std::string, std::string>;

ScenePackage PackageOf(const Contents& contents) {
  ScenePackage package;
  for (const auto& [path, text] : contents) package.files[path].text = text;
  return package;
}

// Returns the error message, or "" if no error occurs.
std::string Refusal(const ScenePackage& package, const fs::path& folder, bool force) {
  try {
    WriteScenePackage(package, folder, force);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

// Returns the files in the folder, except the list of written files.
Contents Shown(const fs::path& folder) {
  Contents files = Files(folder);
  files.erase(".predictor-scene");
  return files;
}

const Contents kOld = {{"scene.urdf", "old"}, {"meshes/a.stl", "a"}, {"meshes/b.stl", "b"}};
const Contents kNew = {{"scene.urdf", "new"}, {"meshes/a.stl", "A"}, {"meshes/c.stl", "c"}};

TEST(WriteScenePackage, MakesTheFolderAndCopiesFiles) {
  const test::TemporaryFolder temporary;
  Write(temporary.path() / "mesh.stl", "triangles");
  ScenePackage package = PackageOf({{"scene.urdf", "text"}});
  package.files["meshes/m.stl"].source = temporary.path() / "mesh.stl";
  WriteScenePackage(package, temporary.path() / "new/deep", false);
  EXPECT_EQ(Shown(temporary.path() / "new/deep"),
            (Contents{{"scene.urdf", "text"}, {"meshes/m.stl", "triangles"}}));
}

TEST(WriteScenePackage, RefusesAFolderThatIsNotEmptyAndForceReplacesOnlyItsOwn) {
  const test::TemporaryFolder to;
  EXPECT_EQ(Refusal(PackageOf(kOld), to.path(), false), "");  // the folder is empty
  Write(to.path() / "meshes/a.stl.meta", "of Unity");
  Write(to.path() / "notes.txt", "mine");
  const Contents before = Files(to.path());
  const std::string refusal = Refusal(PackageOf(kNew), to.path(), false);
  EXPECT_NE(refusal.find("is not empty"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("--force"), std::string::npos) << refusal;
  EXPECT_EQ(Files(to.path()), before);
  EXPECT_EQ(Refusal(PackageOf(kNew), to.path(), true), "");
  Contents expected = kNew;
  expected["meshes/a.stl.meta"] = "of Unity";
  expected["notes.txt"] = "mine";
  EXPECT_EQ(Shown(to.path()), expected);
}

TEST(WriteScenePackage, ForceDoesNotReplaceForeignFiles) {
  for (const std::string path : {"scene.urdf", "meshes/a.stl", ".predictor-scene", "meshes"}) {
    const test::TemporaryFolder to;
    Write(to.path() / path, "not written by an export");
    const Contents before = Files(to.path());
    const std::string refusal = Refusal(PackageOf(kNew), to.path(), true);
    EXPECT_NE(refusal.find((to.path() / path).string()), std::string::npos) << refusal;
    EXPECT_EQ(Files(to.path()), before) << path;
  }
}

TEST(WriteScenePackage, FollowsNoLink) {
  const test::TemporaryFolder to, elsewhere;
  Write(elsewhere.path() / "a.stl", "elsewhere");
  fs::create_directory_symlink(elsewhere.path(), to.path() / "meshes");
  EXPECT_NE(Refusal(PackageOf(kNew), to.path(), true), "");
  EXPECT_EQ(Files(elsewhere.path()), (Contents{{"a.stl", "elsewhere"}}));

  fs::remove(to.path() / "meshes");
  ASSERT_EQ(Refusal(PackageOf(kOld), to.path(), true), "");
  fs::remove(to.path() / "meshes/a.stl");
  fs::create_symlink(elsewhere.path() / "a.stl", to.path() / "meshes/a.stl");
  EXPECT_EQ(Refusal(PackageOf(kNew), to.path(), true), "");
  EXPECT_EQ(Files(elsewhere.path()), (Contents{{"a.stl", "elsewhere"}}));
  EXPECT_FALSE(fs::is_symlink(to.path() / "meshes/a.stl"));
  EXPECT_EQ(Shown(to.path()), kNew);
}

// A forged list must not remove files outside the folder, not even through a symbolic link.
TEST(WriteScenePackage, RejectsAListThatLeadsElsewhere) {
  const test::TemporaryFolder around;
  const fs::path to = around.path() / "to";
  Write(around.path() / "precious", "p");
  Write(around.path() / "there/precious", "p");
  ASSERT_EQ(Refusal(PackageOf(kOld), to, false), "");
  fs::create_directory_symlink(around.path() / "there", to / "link");
  std::ofstream(to / ".predictor-scene", std::ios::app)
      << "../precious\n"
      << (around.path() / "precious").string() << "\nlink/precious\n./../precious\n\n";
  EXPECT_EQ(Refusal(PackageOf(kNew), to, true), "");
  EXPECT_EQ(Read(around.path() / "precious"), "p");
  EXPECT_EQ(Read(around.path() / "there/precious"), "p");
}

TEST(WriteScenePackage, ReportsWhyItCannotWrite) {
  const test::TemporaryFolder to;
  Write(to.path() / "file", "");
  const std::string file = Refusal(PackageOf(kOld), to.path() / "file", true);
  EXPECT_NE(file.find("is a file"), std::string::npos) << file;
  for (const fs::path& folder : {to.path() / "file/below", fs::path("/proc/predictor_scene")}) {
    const std::string refusal = Refusal(PackageOf(kOld), folder, false);
    EXPECT_NE(refusal.find(folder.string()), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("Give a writable folder."), std::string::npos) << refusal;
  }
}

}  // namespace
}  // namespace predictor::scene_export
