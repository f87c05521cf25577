#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/error.h"
#include "scenario/actions/action.h"
#include "scenario/scenario_io.h"
#include "viewer/scene_description.h"

namespace predictor::viewer {
namespace {

namespace fs = std::filesystem;

Scenario Load(const char* name, const std::vector<std::string>& set = {}) {
  return LoadScenario(fs::path(PREDICTOR_SOURCE_DIR) / "scenarios" / name, set);
}

TEST(Reset, ReportsWhichThresholdsItKept) {
  const Scenario scenario = Load("box_9kg.yaml");
  TickRecord record = {};
  record.parameters = {0.5, 1, 1, scenario.safety.force, scenario.safety.torque};
  EXPECT_EQ(KeptThresholds(scenario, record), "");
  record.parameters = {1, 1, 1, 20, 3};
  EXPECT_EQ(KeptThresholds(scenario, record),
            "The reset keeps the tighter thresholds: 20 instead of 30 N, 3 instead of 5 N·m.");
}

TEST(Scene, HasTheMembersOfTheProtocol) {
  AssetStore assets;
  const auto scene = DescribeScene(Load("box_9kg.yaml"), {0.5, 0.1, 0.3}, &assets);
  EXPECT_EQ(scene["name"], "Box of 9 kg with two handles underneath");
  EXPECT_EQ(scene["file"], "box_9kg");
  EXPECT_EQ(scene["mode"], "emulate");
  EXPECT_EQ(scene["simulated"], true);
  EXPECT_EQ(scene["operator"], "virtual");
  EXPECT_EQ(scene["cobot"]["joints"].size(), 7u);
  EXPECT_EQ(scene["cobot"]["joints"][0], "panda_joint1");
  EXPECT_EQ(scene["cobot"]["end_effector"], "panda_link8");
  EXPECT_EQ(scene["handles"]["left"]["p"].dump(), "[0.0,-0.12,-0.1]");
  EXPECT_EQ(scene["handles"]["left"]["q"].dump(), "[1.0,0.0,0.0,0.0]");
  EXPECT_EQ(scene["arms"]["right"]["base"]["p"].dump(), "[0.1,0.25,-0.25]");
  EXPECT_EQ(scene["arms"]["right"]["handle"]["p"].dump(), "[0.0,0.0,0.1]");
  EXPECT_EQ(scene["floor"], true);
  EXPECT_TRUE(scene["table"].is_null());
  EXPECT_EQ(scene["thresholds"]["force"], 30.0);
  EXPECT_EQ(scene["parameters"]["force"]["max"], 30.0);
  EXPECT_EQ(scene["parameters"].size(), 5u);
  EXPECT_EQ(scene["script"][1]["text"], "Lift the object by 10 cm.");
  EXPECT_EQ(scene["script"][1]["action"], "move");
  // The scene contains the object and three copies of the same robot.
  EXPECT_EQ(scene["arms"]["left"]["urdf"], scene["cobot"]["urdf"]);
  EXPECT_NE(scene["object"]["urdf"], scene["cobot"]["urdf"]);
}

// The name becomes the title of the page. In the title, characters that change the direction of
// text would make the name look like another one.
TEST(Scene, HasAPrintableName) {
  Scenario scenario = Load("box_9kg.yaml");
  scenario.name = "Box \u202egk 9\x1b[2J";
  AssetStore assets;
  EXPECT_EQ(DescribeScene(scenario, Vector3::Zero(), &assets)["name"], "Box \\u202egk 9\\x1b[2J");
}

TEST(Scene, HasTheFixturesInTheWorld) {
  AssetStore assets;
  const auto scene = DescribeScene(Load("slide_on_table.yaml"), Vector3::Zero(), &assets);
  ASSERT_EQ(scene["fixtures"].size(), 2u);
  const auto& table = scene["fixtures"][0];
  EXPECT_EQ(table["shape"], "box");
  EXPECT_EQ(table["size"].dump(), "[0.5,1.0,0.03]");
  EXPECT_EQ(table["pose"]["p"].dump(), "[0.6,0.1,0.12]");
  EXPECT_EQ(table["pose"]["q"].dump(), "[1.0,0.0,0.0,0.0]");
  EXPECT_EQ(table["color"].dump(), "[0.61,0.48,0.34]");
  EXPECT_TRUE(DescribeScene(Load("box_9kg.yaml"), Vector3::Zero(), &assets)["fixtures"].empty());
}

TEST(Scene, HasTheMovableObjects) {
  AssetStore assets;
  Scenario scenario = Load("push_boxes.yaml");
  scenario.environment.objects[1].model = scenario.object.model;
  scenario.environment.objects[1].primitive.reset();
  const auto movables = DescribeScene(scenario, Vector3::Zero(), &assets)["movables"];
  ASSERT_EQ(movables.size(), 2u);
  EXPECT_EQ(movables[0]["name"], "crate");
  EXPECT_EQ(movables[0]["shape"], "box");
  EXPECT_EQ(movables[0]["size"].dump(), "[0.24,0.16,0.14]");
  EXPECT_EQ(movables[0]["color"].dump(), "[0.35,0.55,0.75]");
  EXPECT_EQ(movables[1]["name"], "parcel");
  EXPECT_FALSE(movables[1].contains("shape"));
  const auto scene = DescribeScene(Load("box_9kg.yaml"), Vector3::Zero(), &assets);
  EXPECT_EQ(movables[1]["urdf"], scene["object"]["urdf"]);
  EXPECT_TRUE(scene["movables"].empty());
}

TEST(Scene, ContainsTheOperatorsPlace) {
  AssetStore assets;
  Scenario scenario = Load("box_9kg.yaml");
  scenario.operator_.body = BodySpec{.height = 2, .mass = 80};
  scenario.operator_.stance = StanceSpec{.ground = {1, 0.2, -0.8}, .facing = std::numbers::pi};
  const auto known = DescribeScene(scenario, {0.5, 0.1, 0.3}, &assets)["viewpoint"];
  EXPECT_EQ(known["guess"], false);
  EXPECT_EQ(known["ground"].dump(), "[1.0,0.2,-0.8]");
  EXPECT_DOUBLE_EQ(known["eye"][2].get<double>(), -0.8 + 0.936 * 2);
  EXPECT_DOUBLE_EQ(known["forward"][0].get<double>(), -1);

  // The left handle is on the −y side of the right one, so the operator looks along −x.
  scenario.operator_.stance.reset();
  const auto guess = DescribeScene(scenario, {0.5, 0.1, 0.3}, &assets)["viewpoint"];
  EXPECT_EQ(guess["guess"], true);
  EXPECT_TRUE(guess["ground"].is_null());
  EXPECT_DOUBLE_EQ(guess["forward"][0].get<double>(), -1);
  EXPECT_DOUBLE_EQ(guess["eye"][0].get<double>(), 0.5 + 0.62);
}

// A page draws everything in W, so it must receive the arms' bases in W.
TEST(Scene, HasTheBasesInTheWorldWhereverItIs) {
  Scenario scenario = Load("box_9kg.yaml");
  scenario.environment.shift = PoseSpec{{1, 2, 0.5}, {0, 0, 0.5 * std::numbers::pi}};
  AssetStore assets;
  const auto scene = DescribeScene(scenario, {0.5, 0.1, 0.3}, &assets);
  // The base of the right arm is at (0.1, 0.25, -0.25) in R; W is turned by 90° about z.
  const auto& base = scene["arms"]["right"]["base"];
  EXPECT_NEAR(base["p"][0].get<double>(), 0.25 - 2, 1e-12);
  EXPECT_NEAR(base["p"][1].get<double>(), -(0.1 - 1), 1e-12);
  EXPECT_NEAR(base["p"][2].get<double>(), -0.25 - 0.5, 1e-12);
  EXPECT_NEAR(base["q"][0].get<double>(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(base["q"][3].get<double>(), -std::sqrt(0.5), 1e-12);
  EXPECT_EQ(scene["cobot"]["base"]["p"].dump(), "[0.0,0.0,0.0]");
}

// The guidance centre must be sent in W, although the scenario specifies it relative to the
// object's start.
TEST(Scene, GivesGuidanceInTheWorld) {
  AssetStore assets;
  const auto scene = DescribeScene(Load("bar_circle.yaml"), {0.5, 0.1, 0.3}, &assets);
  EXPECT_EQ(scene["guidance"]["type"], "circle");
  EXPECT_DOUBLE_EQ(scene["guidance"]["center"][0].get<double>(), 0.35);
  EXPECT_DOUBLE_EQ(scene["guidance"]["center"][2].get<double>(), 0.3);
}

TEST(Scene, EveryScenarioHasOne) {
  for (const auto& entry : fs::directory_iterator(fs::path(PREDICTOR_SOURCE_DIR) / "scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    AssetStore assets;
    const auto scene = DescribeScene(LoadScenario(entry.path()), Vector3::Zero(), &assets);
    for (const auto& action : scene["script"])
      EXPECT_TRUE(action["text"].get<std::string>().ends_with(".")) << entry.path();
    EXPECT_NE(assets.Find(scene["cobot"]["urdf"].get<std::string>()), nullptr) << entry.path();
  }
}

TEST(Scene, AnAbsentSideIsNull) {
  AssetStore assets;
  const auto scene = DescribeScene(Load("single_arm.yaml"), Vector3::Zero(), &assets);
  EXPECT_NE(scene["handles"]["left"].is_null(), scene["handles"]["right"].is_null());
  EXPECT_EQ(scene["handles"]["left"].is_null(), scene["arms"]["left"].is_null());
}

TEST(Scene, GivesInstructionsInWords) {
  const auto reported = [](const char* action, const std::vector<std::string>& parameters,
                           double facing = 0) {
    return Instruction(MakeActionSpec(action, 0, parameters), facing);
  };
  const std::vector<std::string> by = {"by=[-0.2, -0.3, 0]"};
  EXPECT_EQ(reported("move", by), "Move the object 20 cm back and 30 cm to the right.");
  EXPECT_EQ(reported("move", by, std::numbers::pi),
            "Move the object 20 cm forward and 30 cm to the left.");
  EXPECT_EQ(reported("move", by, std::numbers::pi / 2),
            "Move the object 30 cm back and 20 cm to the left.");
  EXPECT_EQ(reported("move", {"by=[0, 0.05, -0.125]"}),
            "Lower the object by 12.5 cm and move it 5 cm to the left.");
  EXPECT_EQ(reported("put_down", {"by=[0, 0, -0.05]"}),
            "Lower the object by 5 cm and put it down.");
  EXPECT_EQ(reported("rotate", {"rotate_by=[0, 0, -0.349]"}),
            "Turn the object by 20° clockwise, as seen from above.");
  // A right-handed rotation about the axis that points away from the person raises the left side.
  const std::vector<std::string> tilt = {"rotate_by=[0.4363, 0, 0]"};
  EXPECT_EQ(reported("rotate", tilt), "Tilt the object by 25° so that its left side rises.");
  EXPECT_EQ(reported("rotate", tilt, std::numbers::pi),
            "Tilt the object by 25° so that its right side rises.");
  EXPECT_EQ(reported("rotate", tilt, std::numbers::pi / 2),
            "Tilt the object by 25° so that its far side rises.");
  EXPECT_EQ(reported("rotate", {"rotate_by=[0.2, 0, 0.2]"}),
            "Turn the object by 16.2° about the axis (0.71, 0, 0.71).");
  EXPECT_EQ(reported("push", {"force=[0, 0, -20]"}), "Push the handles down with 20 N.");
  EXPECT_EQ(reported("push", {"force=[45, 0, 0]", "hand=left"}, std::numbers::pi),
            "Push the left handle back with 45 N.");
  EXPECT_EQ(reported("push", {"force=[3, 0, 4]"}), "Push the handles with 5 N.");
  EXPECT_EQ(reported("release", {"hand=left"}), "Let go of the left handle.");
  EXPECT_EQ(reported("grip", {}), "Grip the handles.");
  EXPECT_EQ(reported("circle", {}), "Follow the circle of 15 cm radius, 4 turns, 8 s each.");
}

// ---- served files -------------------------------------------------------------------------------

TEST(Assets, AModelIsServedWithItsMeshesAndNoPathOfThisMachine) {
  AssetStore assets;
  const UrdfModel urdf = ReadUrdf(
      fs::path(PREDICTOR_ROBOT_DATA) / "panda_description/urdf/panda.urdf", {"panda_hand"});
  const std::string path = assets.AddModel(urdf);
  EXPECT_EQ(path, "/models/0/model.urdf");
  const Asset* served = assets.Find(path);
  ASSERT_NE(served, nullptr);
  EXPECT_TRUE(served->needs_token);
  EXPECT_EQ(served->bytes.find(".deps"), std::string::npos);
  EXPECT_EQ(served->bytes.find("/meshes/"), std::string::npos);
  const Asset* mesh = assets.Find("/models/0/0.dae");
  ASSERT_NE(mesh, nullptr);
  EXPECT_TRUE(mesh->needs_token);
  EXPECT_NE(mesh->bytes.find("COLLADA"), std::string::npos);
  EXPECT_NE(served->bytes.find("filename=\"0.dae\""), std::string::npos);
  // The served model must still describe the same robot.
  const UrdfModel again = ParseUrdf(
      [&] {
        // The parser checks that the meshes exist, so the test inserts an existing mesh for each of
        // them.
        std::string text = served->bytes;
        const std::string any = urdf.links[0].visuals.at(0).mesh.string();
        for (int i = 0; i < 64; ++i)
          for (const char* extension : {".dae", ".stl"}) {
            const std::string name = "\"" + std::to_string(i) + extension + "\"";
            for (auto at = text.find(name); at != std::string::npos; at = text.find(name))
              text.replace(at, name.size(), "\"" + any + "\"");
          }
        return text;
      }(),
      "served", "/");
  EXPECT_EQ(again.LinkNames(), urdf.LinkNames());
  EXPECT_EQ(again.joints.size(), urdf.joints.size());
}

TEST(Assets, CommentsAndOddFileNamesAreHandled) {
  const fs::path folder = fs::path(testing::TempDir()) / "viewer & 'assets'";
  fs::create_directories(folder);
  std::ofstream(folder / "a<b>.STL") << "solid x\nendsolid x\n";
  const std::string text =
      "<robot name='r'><!-- <mesh filename=\"/etc/passwd\"/> secret --><link name='l'><visual>"
      "<geometry><mesh filename='a&lt;b&gt;.STL'/></geometry></visual></link></robot>";
  const UrdfModel urdf = ParseUrdf(text, "r.urdf", folder);
  AssetStore assets;
  const Asset* served = assets.Find(assets.AddModel(urdf));
  ASSERT_NE(served, nullptr);
  EXPECT_EQ(served->bytes.find("secret"), std::string::npos);
  EXPECT_EQ(served->bytes.find("passwd"), std::string::npos);
  EXPECT_NE(served->bytes.find("filename=\"0.stl\""), std::string::npos) << served->bytes;
  ASSERT_NE(assets.Find("/models/0/0.stl"), nullptr);
  fs::remove_all(folder);
}

TEST(Scene, NamesKeepOutVolumesOnly) {
  Scenario scenario;
  FixtureSpec shelf, head, unnamed;
  shelf.name = "shelf";
  head.name = "head";
  head.keep_out = unnamed.keep_out = true;
  scenario.environment.fixtures = {shelf, head, unnamed};
  const auto fixtures = DescribeFixtures(scenario, 0);
  EXPECT_FALSE(fixtures[0].contains("name"));
  EXPECT_FALSE(fixtures[0].contains("keep_out"));
  EXPECT_EQ(fixtures[1]["name"], "head");
  EXPECT_EQ(fixtures[2]["keep_out"], true);
  EXPECT_FALSE(fixtures[2].contains("name"));
}

TEST(Assets, OnlyExactPathsAreFound) {
  AssetStore assets;
  assets.AddPage();
  ASSERT_NE(assets.Find("/"), nullptr);
  EXPECT_FALSE(assets.Find("/")->needs_token);
  for (const char* path : {"", "//", "/.", "/..", "/../", "/%2e%2e/", "/index.html/", "/models",
                           "/models/", "/models/0", "/models/0/../../etc/passwd"})
    EXPECT_EQ(assets.Find(path), nullptr) << path;
}

TEST(Assets, AreBounded) {
  AssetStore assets(1000);
  assets.Add("/a", {std::string(600, 'a'), "text/plain"});
  EXPECT_THROW(assets.Add("/b", {std::string(401, 'b'), "text/plain"}), InputError);
  assets.Add("/c", {std::string(400, 'c'), "text/plain"});
  EXPECT_EQ(assets.bytes(), 1000u);
  EXPECT_THROW(assets.AddModel(
                   ReadUrdf(fs::path(PREDICTOR_ROBOT_DATA) / "panda_description/urdf/panda.urdf")),
               InputError);
}

}  // namespace
}  // namespace predictor::viewer
