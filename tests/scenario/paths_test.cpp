#include "scenario/paths.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

// A separate folder tree for each test:
//   project/assets/box.urdf, project/scenarios/, outside/secret.urdf, packages/arm/arm.urdf
class Paths : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* file : {"project/assets/box.urdf", "project/scenarios/mine.urdf",
                             "outside/secret.urdf", "packages/arm/arm.urdf"}) {
      fs::create_directories((root_ / file).parent_path());
      std::ofstream(root_ / file) << "<robot/>";
    }
    setenv("PREDICTOR_PACKAGE_PATH", (root_ / "packages").c_str(), 1);
  }
  void TearDown() override { unsetenv("PREDICTOR_PACKAGE_PATH"); }

  fs::path Scenarios() const { return root_ / "project/scenarios"; }
  fs::path Resolve(const std::string& uri) const { return ResolveModelPath(uri, Scenarios()); }
  std::string ErrorOf(const std::string& uri) const {
    try {
      return "resolved to " + Resolve(uri).string();
    } catch (const InputError& error) {
      return error.what();
    }
  }

  const test::TemporaryFolder temporary_;
  const fs::path root_ = temporary_.path();
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(Paths, RelativePathsReachTheProjectsAssets) {
  EXPECT_EQ(Resolve("mine.urdf"), Scenarios() / "mine.urdf");
  EXPECT_EQ(Resolve("../assets/box.urdf"), root_ / "project/assets/box.urdf");
  EXPECT_EQ(Resolve("./../scenarios/../assets/box.urdf"), root_ / "project/assets/box.urdf");
}

TEST_F(Paths, PackagesAreFoundInTheConfiguredFolders) {
  EXPECT_EQ(Resolve("package://arm/arm.urdf"), root_ / "packages/arm/arm.urdf");
}

TEST_F(Paths, PinnedRobotsAreFoundByBothNames) {
  const fs::path panda = fs::canonical(fs::path(PREDICTOR_ROBOT_DATA) / "panda_description");
  EXPECT_EQ(Resolve("package://example-robot-data/robots/panda_description/urdf/panda.urdf"),
            panda / "urdf/panda.urdf");
  EXPECT_EQ(Resolve("package://panda_description/urdf/panda.urdf"), panda / "urdf/panda.urdf");
  EXPECT_EQ(
      Resolve("package://example-robot-data/robots/panda_description/meshes/visual/link0.dae"),
      panda / "meshes/visual/link0.dae");
}

TEST_F(Paths, MeshesBesideAModelInAPackageAreReached) {
  fs::create_directories(root_ / "packages/arm/meshes");
  std::ofstream(root_ / "packages/arm/meshes/link.stl") << "x";
  fs::create_directories(root_ / "packages/arm/urdf");
  EXPECT_EQ(ResolveModelPath("../meshes/link.stl", root_ / "packages/arm/urdf"),
            root_ / "packages/arm/meshes/link.stl");
}

TEST_F(Paths, NothingOutsideIsRead) {
  for (const std::string& uri :
       {std::string("../../outside/secret.urdf"), std::string("/etc/passwd"),
        (root_ / "outside/secret.urdf").string(),
        "file://" + (root_ / "outside/secret.urdf").string(),
        std::string("../assets/../../outside/secret.urdf"),
        std::string("package://arm/../../outside/secret.urdf"),
        std::string("package://../outside/secret.urdf")}) {
    EXPECT_SAYS(ErrorOf(uri), "outside the readable folders");
  }
}

TEST_F(Paths, WithoutAssetsTheFolderItselfIsTheLimit) {
  fs::remove_all(root_ / "project/assets");
  std::ofstream(root_ / "project/other.urdf") << "<robot/>";
  EXPECT_SAYS(ErrorOf("../other.urdf"), "outside the readable folders");
  EXPECT_EQ(Resolve("mine.urdf"), Scenarios() / "mine.urdf");
}

// A folder named assets in a higher folder, for example in a home folder, must grant no access.
TEST_F(Paths, OnlyTheAssetsBesideTheScenariosFolderAreRead) {
  fs::create_directories(root_ / "assets");
  for (const char* file : {"assets/far.urdf", "private.urdf", "project/near.urdf"})
    std::ofstream(root_ / file) << "<robot/>";
  for (const char* uri : {"../../private.urdf", "../../assets/far.urdf",
                          "../../outside/secret.urdf", "../near.urdf", "../assets/../near.urdf"}) {
    EXPECT_SAYS(ErrorOf(uri), "outside the readable folders");
  }
  EXPECT_EQ(Resolve("../assets/box.urdf"), root_ / "project/assets/box.urdf");
}

TEST_F(Paths, AssetsThatAreASymlinkOpenNothing) {
  fs::remove_all(root_ / "project/assets");
  fs::create_directory_symlink(root_ / "outside", root_ / "project/assets");
  EXPECT_SAYS(ErrorOf("../assets/secret.urdf"), "outside the readable folders");
}

// A model may refer to any file in the area that its scenario may read, wherever the model itself
// is stored.
TEST_F(Paths, MeshesMayBeWhereverTheScenarioMayRead) {
  const fs::path urdf = root_ / "project/assets/arm/urdf";
  fs::create_directories(urdf);
  fs::create_directories(root_ / "project/assets/arm/meshes");
  std::ofstream(root_ / "project/assets/arm/meshes/link.stl") << "x";
  EXPECT_EQ(ResolveModelPath("../meshes/link.stl", urdf, Scenarios()),
            root_ / "project/assets/arm/meshes/link.stl");
  EXPECT_THROW(ResolveModelPath("../meshes/link.stl", urdf), InputError);
  EXPECT_THROW(ResolveModelPath("../../../../outside/secret.urdf", urdf, Scenarios()), InputError);
}

TEST_F(Paths, SymlinksAreResolvedBeforeTheyAreJudged) {
  fs::create_symlink(root_ / "outside/secret.urdf", Scenarios() / "link.urdf");
  fs::create_directory_symlink(root_ / "outside", root_ / "packages/evil");
  fs::create_symlink(root_ / "project/assets/box.urdf", Scenarios() / "good.urdf");
  fs::create_symlink(Scenarios() / "loop.urdf", Scenarios() / "loop.urdf");
  EXPECT_SAYS(ErrorOf("link.urdf"), "outside the readable folders");
  EXPECT_SAYS(ErrorOf("package://evil/secret.urdf"), "outside the readable folders");
  EXPECT_EQ(Resolve("good.urdf"), root_ / "project/assets/box.urdf");
  EXPECT_SAYS(ErrorOf("loop.urdf"), "does not exist");
}

TEST_F(Paths, ASiblingThatSharesAPrefixIsOutside) {
  fs::create_directories(root_ / "project-two");
  std::ofstream(root_ / "project-two/x.urdf") << "<robot/>";
  EXPECT_SAYS(ErrorOf("../../project-two/x.urdf"), "outside the readable folders");
}

TEST_F(Paths, RemoteAddressesAreRefused) {
  EXPECT_SAYS(ErrorOf("http://example.com/arm.urdf"), "remote address");
  EXPECT_SAYS(ErrorOf("https://example.com/arm.urdf"), "remote address");
  EXPECT_SAYS(ErrorOf("model://box"), "remote address");
}

TEST_F(Paths, MissingFilesAreNamedWithASimilarName) {
  EXPECT_SAYS(ErrorOf("../assets/bax.urdf"), "does not exist");
  EXPECT_SAYS(ErrorOf("../assets/bax.urdf"), "Did you mean box.urdf?");
  EXPECT_SAYS(ErrorOf("package://arn/arm.urdf"), "Did you mean arm?");
  EXPECT_SAYS(ErrorOf("package://arn/arm.urdf"), "PREDICTOR_PACKAGE_PATH");
  // All packages have names with the same ending, but this ending must not make their names
  // similar.
  EXPECT_SAYS(ErrorOf("package://pandas_description/a.urdf"), "Did you mean panda_description?");
  EXPECT_EQ(ErrorOf("package://my_description/a.urdf").find("Did you mean"), std::string::npos);
  EXPECT_SAYS(ErrorOf("package://arm/amr.urdf"), "Did you mean arm.urdf?");
  EXPECT_SAYS(ErrorOf("package://arm"), "does not name a file");
  EXPECT_SAYS(ErrorOf("package:///etc/passwd"), "does not name a file");
}

TEST_F(Paths, OnlyRegularFilesOfReasonableSizeAreRead) {
  EXPECT_SAYS(ErrorOf("../assets"), "is not a file");
  ASSERT_EQ(mkfifo((Scenarios() / "pipe.urdf").c_str(), 0600), 0);
  EXPECT_SAYS(ErrorOf("pipe.urdf"), "is not a file");
  std::ofstream(Scenarios() / "large.urdf") << "x";
  fs::resize_file(Scenarios() / "large.urdf", (64u << 20) + 1);
  EXPECT_SAYS(ErrorOf("large.urdf"), "is too large");
  fs::resize_file(Scenarios() / "large.urdf", 64u << 20);
  EXPECT_EQ(Resolve("large.urdf"), Scenarios() / "large.urdf");
}

TEST_F(Paths, OddTextIsRefused) {
  EXPECT_SAYS(ErrorOf(""), "Write the path of a file");
  EXPECT_SAYS(ErrorOf(std::string("a\0b", 3)), "Write the path of a file");
  EXPECT_SAYS(ErrorOf(std::string(100000, 'a')), "Write the path of a file");
  // The name is longer than any allowed file name.
  EXPECT_SAYS(ErrorOf(std::string(3000, 'a')), "does not exist");
}

}  // namespace
}  // namespace predictor
