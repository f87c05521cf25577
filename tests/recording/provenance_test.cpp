// Restores the files from which a run was made, in another folder.
#include "recording/provenance.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "models/urdf.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class Provenance : public testing::Test {
 protected:
  fs::path Folder(const char* name) const {
    fs::create_directories(folder_ / name);
    return folder_ / name;
  }
  static void Write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

Scenario Load(const std::string& name, const std::vector<std::string>& set = {}) {
  return LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml", set);
}

TEST_F(Provenance, AScenarioIsRestoredWithItsModels) {
  const Scenario scenario = Load("box_9kg", {"seed=7", "safety.force=21"});
  const RecordingHeader header = DescribeRun(scenario, "1.2.3", {{"person", "7"}});
  EXPECT_EQ(header.seed, 7U);
  EXPECT_EQ(header.scenario_name, "box_9kg");
  EXPECT_EQ(header.labels.at("person"), "7");
  EXPECT_EQ(header.model_hashes.count("assets/box_9kg.urdf"), 1U);
  const Scenario restored = RestoreScenario(header, Folder("restored"));
  EXPECT_EQ(restored.safety.force, 21);
  EXPECT_EQ(SaveScenario(restored), header.scenario_yaml);
  const fs::path object = ResolveModelPath(restored.object.model, restored.folder());
  EXPECT_EQ(object, fs::canonical(folder_) / "restored/assets/box_9kg.urdf");
}

// The user has two robots: one below the scenario's folder with a mesh next to it, and one in a
// package.
TEST_F(Provenance, OwnRobotsComeWithTheirMeshes) {
  const char* kUrdf =
      "<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' "
      "ixy='0' ixz='0' iyz='0'/></inertial><visual><geometry><mesh filename='MESH'/></geometry>"
      "</visual></link></robot>";
  const auto with = [&](const std::string& mesh) {
    std::string text = kUrdf;
    return text.replace(text.find("MESH"), 4, mesh);
  };
  const fs::path here = Folder("here/study");
  const std::string stl(84, '\0');
  Write(here / "object/box.urdf", with("box.stl"));
  Write(here / "object/box.stl", stl);
  Write(folder_ / "packages/mine/arm.urdf", with("package://mine/meshes/link.stl"));
  Write(folder_ / "packages/mine/meshes/link.stl", stl);
  setenv("PREDICTOR_PACKAGE_PATH", (folder_ / "packages").c_str(), 1);
  Scenario scenario = Load("single_arm");
  scenario.file = here / "single_arm.yaml";
  scenario.object.primitive.reset();
  // an absolute path is restored elsewhere
  scenario.object.model = (here / "object/box.urdf").string();
  scenario.cobot.model = "package://mine/arm.urdf";
  scenario.cobot.remove_links.clear();
  RecordingHeader header = DescribeRun(scenario, "1", {});
  unsetenv("PREDICTOR_PACKAGE_PATH");
  EXPECT_EQ(header.model_hashes.count("scenario/object/box.stl"), 1U);
  EXPECT_EQ(header.model_hashes.count("packages/packages/mine/meshes/link.stl"), 1U);
  fs::rename(folder_ / "here", folder_ / "gone");
  fs::rename(folder_ / "packages", folder_ / "gone too");

  const Scenario restored = RestoreScenario(header, Folder("there"));
  for (const std::string& model : {restored.object.model, restored.cobot.model}) {
    const fs::path urdf = ResolveModelPath(model, restored.folder());
    EXPECT_TRUE(fs::exists(ReadUrdf(urdf, {}, restored.folder()).links[0].visuals[0].mesh));
  }
  unsetenv("PREDICTOR_PACKAGE_PATH");
}

TEST_F(Provenance, AnotherRobotOfTheSameNameIsRefused) {
  RecordingHeader header = DescribeRun(Load("box_9kg"), "1", {});
  for (auto& [name, hash] : header.model_hashes)
    if (name.starts_with("pinned/")) hash[0] = hash[0] == '0' ? '1' : '0';
  EXPECT_THROW(RestoreScenario(header, Folder("restored")), InputError);
}

TEST_F(Provenance, AnAttachmentCannotLeaveItsFolder) {
  for (const char* name : {"../evil", "/etc/evil", "scenario/../../evil", ""}) {
    RecordingHeader header = DescribeRun(Load("box_9kg"), "1", {});
    header.attachments.push_back({name, "", "x"});
    EXPECT_THROW(RestoreScenario(header, Folder("restored")), InputError) << name;
    EXPECT_FALSE(fs::exists(folder_ / "evil"));
  }
}

}  // namespace
}  // namespace predictor
