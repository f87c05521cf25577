// Tests waypoints of a controller from a CSV file.
#include <gtest/gtest.h>

#include "fixture.h"
#include "simulation/controller.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

class TrajectoryFile : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_ / "box.yaml") << FixtureText(); }
  Scenario Load(const std::string& csv, std::vector<std::string> overrides = {}) const {
    std::ofstream(folder_ / "path.csv", std::ios::binary) << csv;
    overrides.insert(overrides.begin(), {"cobot.controller.trajectory=[]",
                                         "cobot.controller.trajectory_file=path.csv"});
    return LoadScenario(folder_ / "box.yaml", overrides);
  }
  // Returns the error message without the path of the folder.
  std::string Error(const std::string& csv, const std::vector<std::string>& overrides = {}) const {
    try {
      Load(csv, overrides);
    } catch (const InputError& error) {
      std::string text = error.what();
      const std::string path = folder_.path().string() + "/";
      for (auto at = text.find(path); at != std::string::npos; at = text.find(path))
        text.erase(at, path.size());
      return text;
    }
    return "";
  }

  test::TemporaryFolder folder_;
};

TEST_F(TrajectoryFile, BelongsToEachControllerWhoseSetPointMoves) {
  for (const char* type : {"admittance", "hybrid_force_position"}) {
    const Scenario scenario =
        Load("time,x,y,z\n2,0.1,0,0\n",
             {std::string("cobot.controller={type: ") + type + ", trajectory_file: path.csv}"});
    const YamlNode* trajectory = scenario.cobot.controller.parameters.Find("trajectory");
    ASSERT_NE(trajectory, nullptr) << type;
    EXPECT_EQ(trajectory->items.size(), 1u) << type;
  }
}

TEST_F(TrajectoryFile, GivesTheSameWaypointsAsTheScenario) {
  const Scenario expected = LoadScenario(
      folder_ / "box.yaml", {"cobot.controller.trajectory=[{time: 1, xyz: [0.1, 0, -2e-2]}, "
                             "{time: 2.5, xyz: [0, 0, 0]}]"});
  for (const char* csv : {"time,x,y,z\n1,0.1,0,-2e-2\n2.5,0,0,0\n",
                          "\xEF\xBB\xBFtime, x, y, z\r\n1, 0.1 ,0,\t-0.02\r\n\r\n2.5,0,0,0"})
    EXPECT_EQ(SaveScenario(Load(csv)), SaveScenario(expected));
  const Scenario turned = LoadScenario(
      folder_ / "box.yaml",
      {"cobot.controller.trajectory=[{time: 1, xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]}]"});
  EXPECT_EQ(SaveScenario(Load("time,x,y,z,roll,pitch,yaw\n1,1,2,3,0.1,0.2,0.3\n")),
            SaveScenario(turned));
}

// A recording contains the saved scenario, which must not need the CSV file.
TEST_F(TrajectoryFile, IsNotNeededByTheSavedScenario) {
  const std::string saved = SaveScenario(Load("time,x,y,z\n1,0.1,0,0\n"));
  EXPECT_EQ(SaveScenario(ParseScenario(saved, "saved.yaml", "/")), saved);
}

TEST_F(TrajectoryFile, ErrorsNameFileAndLine) {
  EXPECT_EQ(Error("t,x,y,z\n1,0,0,0\n"),
            "path.csv:1:1: the header is \"t,x,y,z\"; it must be time,x,y,z or "
            "time,x,y,z,roll,pitch,yaw.");
  EXPECT_EQ(Error("time,x,y,z\n1,0,0,0\n2,0,0\n"),
            "path.csv:3:1: this row has 3 values; the header has 4. Give one value for each "
            "column.");
  EXPECT_EQ(Error("time,x,y,z\n1,0,0,0\n2,0,left,0\n").substr(0, 15), "path.csv:3:5: c");
  EXPECT_NE(Error("time,x,y,z\n1,0,nan,0\n").find("path.csv:2:5: "), std::string::npos);
  EXPECT_NE(Error("time,x,y,z\n1,0,.inf,0\n").find("path.csv:2:5: "), std::string::npos);
  EXPECT_EQ(Error("time,x,y,z\n1,0,20,0\n"),
            "path.csv:2:5: cobot.controller.trajectory.0.xyz.1 is 20 m; it must be from -10 to "
            "10 m.");
  EXPECT_NE(Error("time,x,y,z\n").find("the file has no waypoints. Begin the file with the header"),
            std::string::npos);
  EXPECT_NE(Error("").find("no waypoints"), std::string::npos);
  std::string many = "time,x,y,z\n";
  for (int i = 1; i <= 1001; ++i) many += std::to_string(i) + ",0,0,0\n";
  EXPECT_EQ(Error(many).find("path.csv:1002:1: there are more than 1000 waypoints."), 0u);
  EXPECT_NE(Error(std::string(2 << 20, ' ')).find("more than 1048576 bytes"), std::string::npos);
}

TEST_F(TrajectoryFile, ErrorsNameTheKeyOfAFileThatCannotBeUsed) {
  const std::string csv = "time,x,y,z\n1,0,0,0\n";
  EXPECT_NE(Error(csv, {"cobot.controller.trajectory_file=paht.csv"})
                .find("cobot.controller.trajectory_file: \"paht.csv\" does not exist"),
            std::string::npos);
  EXPECT_NE(Error(csv, {"cobot.controller.trajectory_file=/etc/passwd"})
                .find("outside the readable folders"),
            std::string::npos);
  EXPECT_NE(Error(csv, {"cobot.controller.trajectory=[{time: 1}]"}).find("there is also a"),
            std::string::npos);
  EXPECT_NE(Error(csv, {"cobot.controller={type: joint_impedance, trajectory_file: path.csv}"})
                .find("has no effect in joint_impedance"),
            std::string::npos);
}

}  // namespace
}  // namespace predictor
