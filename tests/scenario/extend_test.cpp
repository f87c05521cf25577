// Tests scenarios that extend another one (`extends`), and angles in degrees.
#include <gtest/gtest.h>

#include <numbers>

#include "fixture.h"
#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

class Extend : public testing::Test {
 protected:
  // Writes a file and returns its path.
  std::filesystem::path Write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
  }
  std::string Error(const std::filesystem::path& file,
                    const std::vector<std::string>& overrides = {}) {
    try {
      LoadScenario(file, overrides);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
};

TEST_F(Extend, KeysOfTheFileComeBeforeThoseOfTheExtendedOne) {
  Write("base.yaml", FixtureText());
  const Scenario scenario = LoadScenario(
      Write("mine.yaml",
            "predictor: 1\nextends: base.yaml\nname: Mine\ncobot: {base: {xyz: [1, 2, 3]}}\n"
            "operator: {script: [{action: hold}]}\n"),
      {"seed=7"});
  Scenario expected = Fixture(
      {"name=Mine", "cobot.base.xyz=[1, 2, 3]", "seed=7", "operator.script=[{action: hold}]"});
  EXPECT_EQ(SaveScenario(scenario), SaveScenario(expected));
  EXPECT_EQ(scenario.file.filename(), "mine.yaml");
}

TEST_F(Extend, GoesThroughSeveralFilesAndFoldersBelow) {
  Write("common/all.yaml", FixtureText());
  Write("common/second.yaml", "extends: all.yaml\nname: Second\nseed: 2\n");
  const Scenario scenario =
      LoadScenario(Write("mine.yaml", "extends: common/second.yaml\nseed: 3\n"));
  EXPECT_EQ(SaveScenario(scenario), SaveScenario(Fixture({"name=Second", "seed=3"})));
}

TEST_F(Extend, AGroupOfAnotherTypeIsReplacedWhole) {
  Write("base.yaml", FixtureText());
  const Scenario scenario = LoadScenario(
      Write("mine.yaml", "extends: base.yaml\ncobot: {controller: {type: joint_impedance}}\n"));
  EXPECT_EQ(SaveScenario(scenario),
            SaveScenario(Fixture({"cobot.controller={type: joint_impedance}"})));
}

TEST_F(Extend, AnErrorNamesTheFileThatHoldsTheValue) {
  std::string base = FixtureText();
  const std::string seed = "\nseed: 1\n";
  const std::size_t at = base.find(seed);
  ASSERT_NE(at, std::string::npos);
  const auto line = 2 + std::count(base.begin(), base.begin() + static_cast<long>(at), '\n');
  Write("base.yaml", base.replace(at, seed.size(), "\nseed: -1\n"));
  const auto mine = Write("mine.yaml", "extends: base.yaml\nnam: Mine\n");
  const std::string error = Error(mine);
  EXPECT_NE(error.find("base.yaml:" + std::to_string(line) + ":7: seed is -1"), std::string::npos)
      << error;
  EXPECT_NE(error.find("mine.yaml:2:1: \"nam\" is not a key"), std::string::npos) << error;
}

TEST_F(Extend, WhatCannotBeExtendedIsRefusedWithItsPlace) {
  const auto mine = Write("mine.yaml", "extends: other.yaml\n");
  EXPECT_NE(Error(mine).find("mine.yaml:1:10: extends is \""), std::string::npos) << Error(mine);
  EXPECT_NE(Error(mine).find("file does not exist"), std::string::npos) << Error(mine);

  Write("other.yaml", "extends: mine.yaml\n");
  EXPECT_NE(Error(mine).find("other.yaml:1:10: extends leads back to "), std::string::npos)
      << Error(mine);

  Write("other.yaml", "- 1\n");
  EXPECT_NE(Error(mine).find("other.yaml:1:1: a scenario must be a group of keys"),
            std::string::npos);

  Write("outside.yaml", FixtureText());
  for (const char* name : {"../outside.yaml", "/etc/passwd", "sub/../../outside.yaml"}) {
    const auto below = Write("below/mine.yaml", std::string("extends: ") + name + "\n");
    EXPECT_NE(Error(below).find("which is outside"), std::string::npos) << Error(below);
  }
  for (const char* bad : {"extends:\n", "extends: [a]\n", "extends: \"\"\n"})
    EXPECT_NE(Error(Write("mine.yaml", bad)).find("extends must be the path of a scenario"),
              std::string::npos);
}

TEST_F(Extend, AChainHasAnEnd) {
  Write("f0.yaml", FixtureText());
  for (int i = 1; i < 10; ++i)
    Write("f" + std::to_string(i) + ".yaml", "extends: f" + std::to_string(i - 1) + ".yaml\n");
  EXPECT_EQ(Error(folder_.path() / "f7.yaml"), "");
  EXPECT_NE(Error(folder_.path() / "f8.yaml").find("more than 8 scenarios"), std::string::npos);
}

// A recording contains the complete scenario, so the program must not read other files to load it.
TEST(ExtendInText, IsRefused) {
  EXPECT_NE(ErrorOf("extends: base.yaml\n").find("extends is supported in files only"),
            std::string::npos);
  EXPECT_NE(ErrorOf(FixtureText(), {"extends=base.yaml"}).find("\"extends\" is not a key"),
            std::string::npos);
}

TEST(Degrees, AreReadWhereAnAngleStands) {
  const Scenario scenario =
      Fixture({"cobot.base.rpy=[180 deg, -45 deg, 0.5]", "rendering.joint_security=3 deg"});
  ASSERT_EQ(scenario.cobot.base.rpy.size(), 3);
  EXPECT_DOUBLE_EQ(scenario.cobot.base.rpy[0], std::numbers::pi);
  EXPECT_DOUBLE_EQ(scenario.cobot.base.rpy[1], -std::numbers::pi / 4);
  EXPECT_EQ(scenario.cobot.base.rpy[2], 0.5);
}

TEST(Degrees, AreRefusedElsewhereAndBeyondTheRange) {
  EXPECT_NE(ErrorOf(FixtureText(), {"duration=30 deg"}), "");
  EXPECT_NE(ErrorOf(FixtureText(), {"cobot.base.xyz=[1 deg, 0, 0]"}), "");
  EXPECT_NE(ErrorOf(FixtureText(), {"cobot.base.rpy=[400 deg, 0, 0]"})
                .find("cobot.base.rpy.0 is \"400 deg\"; it must be from -6.2832 to 6.2832 rad"),
            std::string::npos);
  for (const char* bad : {"deg", "30deg", "30 degrees", "x deg", "inf deg", "1e999 deg", "- deg"})
    EXPECT_NE(ErrorOf(FixtureText(), {"cobot.base.rpy=[" + std::string(bad) + ", 0, 0]"}), "")
        << bad;
}

// A shift moves the scene relative to the arms, rotates it about the vertical, and changes nothing
// else.
TEST(Shift, PutsTheBasesIntoTheWorld) {
  const Scenario scenario =
      Fixture({"environment.shift={xyz: [1, 2, 3], rpy: [0, 0, 90 deg]}",
               "device.arms.left.base={xyz: [1, 3, 3.5], rpy: [0, 0, 120 deg]}"});
  const Pose X_WB = scenario.X_WB(0);
  EXPECT_LT((X_WB.p - Vector3(1, 0, 0.5)).norm(), 1e-12);
  EXPECT_LT((RpyOf(X_WB.q) - Vector3(0, 0, std::numbers::pi / 6)).norm(), 1e-12);
  EXPECT_TRUE(scenario.HasFixedArms());
  EXPECT_FALSE(Fixture().HasFixedArms());
}

TEST(Shift, RefusesWhatTiltsGravityOrIsFarOff) {
  const auto error = [](const std::string& shift) {
    return ErrorOfOverride("environment.shift=" + shift);
  };
  EXPECT_EQ(error("{rpy: [0.1, 0, 0]}")
                .find("--set environment.shift:1:8: environment.shift.rpy.0 is "
                      "0.1 rad, but the scene can only be turned about"),
            0U)
      << error("{rpy: [0.1, 0, 0]}");
  EXPECT_NE(error("{rpy: [0, -5 deg, 0]}").find("environment.shift.rpy.1 is -0.087"),
            std::string::npos);
  EXPECT_NE(error("{xyz: [0, 9, 9]}").find("environment.shift.xyz is 12.7"), std::string::npos);
  EXPECT_NE(error("{xyz: [0, 0, .nan]}").find("must be a finite number"), std::string::npos);
  EXPECT_NE(error("{xyz: [400, 0, 0]}").find("from -100 to 100 m"), std::string::npos);
  EXPECT_NE(error("{yaw: 1}").find("yaw"), std::string::npos);
  EXPECT_EQ(error("{xyz: [0, 6, -7], rpy: [0, 0, -180 deg]}"), "");
  EXPECT_EQ(error("null"), "");
}

}  // namespace
}  // namespace predictor
