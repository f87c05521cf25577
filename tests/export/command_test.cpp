// Tests `predictor export scene` as a script or a shell uses it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "export/files.h"
#include "support/text.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;

struct Result {
  int code = -1;
  std::string text;  // standard output and error
};

Result Export(const std::string& arguments, const fs::path& from = ".") {
  const std::string command =
      "cd '" + from.string() + "' && '" PREDICTOR_BINARY "' export scene " + arguments + " 2>&1";
  Result result;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> text;
  for (std::size_t n; (n = fread(text.data(), 1, text.size(), pipe)) > 0;) {
    result.text.append(text.data(), n);
  }
  const int status = pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

const std::string kScenario = PREDICTOR_SOURCE_DIR "/scenarios/single_arm.yaml";

TEST(ExportCommand, WritesThePackageAndNamesItsFolder) {
  const test::TemporaryFolder to;
  const Result result = Export(kScenario + " -o '" + (to.path() / "scene").string() + "'");
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_TRUE(Contains(result.text, (to.path() / "scene/README.txt").string())) << result.text;
  const auto files = Files(to.path() / "scene");
  for (const char* file : {"scene.urdf", "package.xml", "README.txt"}) {
    EXPECT_EQ(files.count(file), 1u) << file;
  }
  const Result again = Export(kScenario + " --quiet -o '" + (to.path() / "again").string() + "'");
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.text, "");
  EXPECT_EQ(Files(to.path() / "again"), files);
}

TEST(ExportCommand, ListsTheFilesAsJson) {
  const test::TemporaryFolder to;
  const std::string scene = (to.path() / "scene").string();
  const Result result = Export(kScenario + " --quiet --json -o '" + scene + "'");
  EXPECT_EQ(result.code, 0) << result.text;
  const auto json = nlohmann::json::parse(result.text);
  EXPECT_EQ(json["folder"], scene);
  EXPECT_EQ(json["files"].size() + 1, Files(scene).size());  // plus the list of written files
  for (const std::string file : json["files"]) EXPECT_TRUE(fs::exists(scene + "/" + file)) << file;
}

TEST(ExportCommand, NamesTheFolderAfterTheScenario) {
  const test::TemporaryFolder here;
  EXPECT_EQ(Export(kScenario, here.path()).code, 0);
  EXPECT_TRUE(fs::exists(here.path() / "single_arm_scene/scene.urdf"));
}

TEST(ExportCommand, TakesChangesOfTheScenario) {
  const test::TemporaryFolder to;
  const std::string folder = " --force -o '" + to.path().string() + "'";
  ASSERT_EQ(Export(kScenario + folder).code, 0);
  EXPECT_FALSE(Contains(Read(to.path() / "scene.urdf"), "<mass value=\"7.5\"/>"));
  ASSERT_EQ(Export(kScenario + folder + " --set object.primitive.mass=7.5").code, 0);
  EXPECT_TRUE(Contains(Read(to.path() / "scene.urdf"), "<mass value=\"7.5\"/>"));
}

TEST(ExportCommand, RefusesBadInputInASentence) {
  const test::TemporaryFolder to;
  Write(to.path() / "full/mine.txt", "mine");
  Write(to.path() / "file", "");
  const auto at = [&](const std::string& name) {
    return " -o '" + (to.path() / name).string() + "'";
  };
  const struct {
    std::string arguments, sentence;
  } cases[] = {
      {kScenario + at("full"), "is not empty. Give another folder, or use --force"},
      {kScenario + at("file"), "is a file. Give a folder"},
      {kScenario + " -o /proc/scene", "\"/proc/scene\" cannot be written"},
      {kScenario + at("new") + " --set cobot.end_effector=panda_link88",
       "Did you mean panda_link8?"},
      {kScenario + at("new") + " --set cobot.effort_limit=[1,2]", "--set cobot.effort_limit"},
      {(to.path() / "no.yaml").string() + at("new"), "no.yaml"},
      {"", "SCENARIO is missing"},
      {kScenario + " --duration 3", "--duration"},
  };
  for (const auto& c : cases) {
    const Result result = Export(c.arguments);
    EXPECT_EQ(result.code, 2) << c.arguments << result.text;
    EXPECT_TRUE(Contains(result.text, c.sentence)) << c.arguments << "\n" << result.text;
  }
  EXPECT_EQ(Files(to.path()).size(), 2u);
  EXPECT_FALSE(fs::exists(to.path() / "new"));
}

}  // namespace
}  // namespace predictor::scene_export
