// If the program finds an error only after it has loaded the models, the message must name the key
// and its place in the scenario.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "emulator/emulator.h"
#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"
#include "support/test_name.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

const fs::path kScenarios = fs::path(PREDICTOR_SOURCE_DIR) / "scenarios";

std::string TextOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string Box() { return TextOf(kScenarios / "box_9kg.yaml"); }

// Returns `text` with the `nth` occurrence (from 0) of `from` replaced by `to`.
std::string Replace(std::string text, const std::string& from, const std::string& to, int nth = 0) {
  std::size_t at = text.find(from);
  for (int i = 0; i < nth && at != std::string::npos; ++i) at = text.find(from, at + 1);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Returns the place "box.yaml:line:column: " of the `nth` occurrence of `word`.
std::string PlaceIn(const std::string& text, const std::string& word, int nth = 0) {
  std::size_t at = text.find(word);
  for (int i = 0; i < nth && at != std::string::npos; ++i) at = text.find(word, at + 1);
  EXPECT_NE(at, std::string::npos) << word;
  const std::string before = text.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  return "box.yaml:" + std::to_string(line) + ":" + std::to_string(at - before.rfind('\n')) + ": ";
}

// Returns the error message of an emulator for the scenario, or "" if it starts.
std::string ErrorOf(const std::string& text, const std::vector<std::string>& set = {},
                    const fs::path& folder = kScenarios) {
  try {
    const Emulator emulator(ParseScenario(text, "box.yaml", folder, set));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void ExpectBegins(const std::string& error, const std::string& beginning) {
  EXPECT_EQ(error.rfind(beginning, 0), 0u) << "expected: " << beginning << "\ngot:      " << error;
}

// ---- in the file ------------------------------------------------------------------------------

TEST(Wiring, ReportsAnUnknownLink) {
  const std::string cobot = Replace(Box(), "panda_link8", "panda_lnk8", 0);
  ExpectBegins(ErrorOf(cobot), PlaceIn(cobot, "panda_lnk8") +
                                   "cobot.end_effector: \"panda_lnk8\" is not a link of the robot "
                                   "\"panda\". Did you mean panda_link8?");
  const std::string left = Replace(Box(), "panda_link8", "nope", 1);
  ExpectBegins(ErrorOf(left), PlaceIn(left, "nope") +
                                  "device.arms.left.end_effector: \"nope\" is not a link of the "
                                  "robot \"panda\". The known names are: panda_link0,");
  const std::string right = Replace(Box(), "elbow: panda_link4", "elbow: nope", 1);
  ExpectBegins(ErrorOf(right), PlaceIn(right, "nope") + "device.arms.right.elbow: \"nope\" is not");
}

TEST(Wiring, ReportsWhichLinkCannotBeRemoved) {
  const std::array<const char*, 3> keys = {"cobot", "device.arms.left", "device.arms.right"};
  for (int i = 0; i < 3; ++i) {
    const std::string text = Replace(Box(), "[panda_hand]", "[panda_hand, nope]", i);
    ExpectBegins(ErrorOf(text), PlaceIn(text, "nope") + keys[static_cast<std::size_t>(i)] +
                                    ".remove_links.1: \"nope\" is not a link of the robot");
  }
  const std::string root = Replace(Box(), "[panda_hand]", "[panda_link0]");
  ExpectBegins(ErrorOf(root),
               PlaceIn(root, "panda_link0") + "cobot.remove_links.0: \"panda_link0\" is the root");
}

// The program finds these errors only when it searches for an equilibrium.
TEST(Wiring, ReportsWhyTheCobotCannotHoldTheObject) {
  const std::string heavy = Replace(Box(), "box_9kg.urdf", "box_18kg.urdf");
  ExpectBegins(ErrorOf(heavy), PlaceIn(heavy, "model: package") +
                                   "cobot.effort_limit: the cobot cannot hold the object");
  const std::string sags =
      Replace(Box(), "[0, -0.3, 0, -2.0, 0, 1.7, 0.785]", "[0, 1.7, 0, -0.3, 0, 1.7, 0.785]");
  // Without a floor, because the object would begin inside it.
  ExpectBegins(ErrorOf(sags, {"cobot.effort_limit=[1e3, 1e3, 1e3, 1e3, 1e3, 1e3, 1e3]",
                              "environment.floor=false"}),
               PlaceIn(sags, "type: cartesian") +
                   "cobot.controller: the cobot cannot hold the object at cobot.posture: it sags "
                   "until joint \"panda_joint2\" reaches its position limit");
}

TEST(Wiring, ReportsWhichModelIsMissing) {
  const std::string object = Replace(Box(), "box_9kg.urdf", "box_9kgs.urdf");
  ExpectBegins(ErrorOf(object), PlaceIn(object, "../assets/box_9kgs.urdf") +
                                    "object.model: \"../assets/box_9kgs.urdf\" does not exist:");
  for (int i = 0; i < 3; ++i) {
    const std::string key = i == 0 ? "cobot" : i == 1 ? "device.arms.left" : "device.arms.right";
    const std::string text = Replace(Box(), "/urdf/panda.urdf", "/urdf/pandas.urdf", i);
    const std::string error = ErrorOf(text);
    EXPECT_NE(error.find(key + ".model: \"package://"), std::string::npos) << error;
    ExpectBegins(error, PlaceIn(text, "package://", i));
  }
}

// ---- in an override ---------------------------------------------------------------------------

struct Case {
  const char* set;
  const char* error;
};

class Override : public testing::TestWithParam<Case> {};

TEST_P(Override, IsNamedWithItsKey) {
  ExpectBegins(ErrorOf(Box(), {GetParam().set}), GetParam().error);
}

const Case kCases[] = {
    {"cobot.posture=[0, 0]",
     "--set cobot.posture: cobot.posture has 2 values; the arm has 7 joints"},
    {"cobot.posture=[0, 0, 0, -2, 0, 9, 0]",
     "--set cobot.posture:1:18: cobot.posture.5: joint \"panda_joint6\" at 9 rad is outside"},
    {"cobot.effort_limit=[1, 2]",
     "--set cobot.effort_limit: cobot.effort_limit has 2 values. Give none"},
    {"cobot.effort_limit=[870, 870, 870, 870, 120, 5, 120]",
     "--set cobot.effort_limit: cobot.effort_limit: the cobot cannot hold the object at "
     "cobot.posture: joint \"panda_joint6\" would need more than its effort limit of 5 N·m"},
    {"cobot.joint_friction.viscous=[1, 2]",
     "--set cobot.joint_friction.viscous: cobot.joint_friction.viscous has 2 values. Give one"},
    {"cobot.controller.type=nope",
     "--set cobot.controller.type: cobot.controller.type is \"nope\"; it must be one of: "
     "admittance, cartesian_impedance, gravity_compensation, "},
    {"cobot.controller={type: joint_impedance, joint_stiffness: [1, 2]}",
     "--set cobot.controller:1:42: cobot.controller.joint_stiffness has 2 values. Give one"},
    {"cobot.controller.trajectory=[{time: 2}, {time: 1}]",
     "--set cobot.controller.trajectory:1:20: cobot.controller.trajectory.1.time is 1 s, which "
     "does not come after 2 s"},
    {"device.arms.left.posture=[1]",
     "--set device.arms.left.posture: device.arms.left.posture has 1 values; the arm has 7 joints"},
    {"device.arms.left.posture=[0, -90, 0, -2.3, 0, 1.8, 0]",
     "--set device.arms.left.posture:1:5: device.arms.left.posture.1: joint \"panda_joint2\" at "
     "-90 rad is outside its limits"},
    {"device.arms.right.posture=[1]", "--set device.arms.right.posture: device.arms.right.posture"},
    {"device.arms.right.velocity_limit=[1, 2]",
     "--set device.arms.right.velocity_limit: device.arms.right.velocity_limit has 2 values; the "
     "arm has 7 joints"},
    {"device.arms.left.acceleration_limit=[1, 2]",
     "--set device.arms.left.acceleration_limit: device.arms.left.acceleration_limit has 2 values"},
    {"rendering.link_pairs=[[panda_link3, panda_link3], [panda_link4, nope]]",
     "--set rendering.link_pairs:1:30: rendering.link_pairs.1 (right arm): \"nope\" is not a link"},
    {"rendering.link_pairs=[[left:panda_link4, left:panda_link4]]",
     "--set rendering.link_pairs:1:2: rendering.link_pairs.0 keeps \"panda_link4\" apart from "
     "itself"},
    {"handles.right.xyz=[0, -2, 0]",
     "--set handles.right.xyz: handles.right.xyz is 1.81 m outside the object's shape"},
    {"device.arms.right.base.xyz=[5, 0, 0]",
     "box.yaml:45:13: device.arms.right.base: the arm cannot move its handle to the start"},
    // The program must report an error in the model's contents at the key that names the model.
    {"device.arms.left={model: ../assets/bar.urdf, end_effector: bar, elbow: bar}",
     "--set device.arms.left:1:9: device.arms.left.model: "}};

INSTANTIATE_TEST_SUITE_P(Wiring, Override, testing::ValuesIn(kCases), [](const auto& c) {
  return std::to_string(c.index) + "_" + test::TestName(c.param.set);
});

// ---- models -----------------------------------------------------------------------------------

class WiringOfModels : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  // Writes an object of 9 kg. The second and the third shape of the object, in lines 4 and 5, use a
  // mesh.
  void WriteBox() const {
    const std::string mesh =
        "<collision><geometry><mesh filename=\"mesh.stl\"/></geometry></collision>\n";
    Write("box.urdf",
          "<robot name=\"box\"><link name=\"box\">\n"
          "<inertial><mass value=\"9\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\"/></inertial>\n"
          "<collision><geometry><box size=\"0.3 0.3 0.2\"/></geometry></collision>\n" +
              mesh + mesh + "</link></robot>");
  }
  std::string Error() const { return ErrorOf(text_, {}, folder_); }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::string text_ = Replace(Box(), "../assets/box_9kg.urdf", "box.urdf");
};

TEST_F(WiringOfModels, AnErrorInAModelNamesItsLineAndTheKeyThatAskedForIt) {
  Write("box.urdf", "<robot name=\"box\">\n<link/>\n</robot>");
  ExpectBegins(Error(), PlaceIn(text_, "box.urdf") +
                            "object.model: " + (folder_ / "box.urdf").string() + ":2: <link> has");
}

TEST_F(WiringOfModels, AMeshThatTheEngineRefusesIsNamedWithItsPlace) {
  WriteBox();
  Write("mesh.stl", "solid nothing\nendsolid nothing\n" + std::string(100, ' '));
  ExpectBegins(Error(), PlaceIn(text_, "box.urdf") +
                            "object.model: " + (folder_ / "box.urdf").string() + ":4: The mesh " +
                            (folder_ / "mesh.stl").string() + " cannot be used: ");
  EXPECT_EQ(Error().find('\n'), std::string::npos) << Error();
}

TEST_F(WiringOfModels, TwoShapesMayBeOfOneMesh) {
  WriteBox();
  // The mesh is a tetrahedron in binary STL.
  const std::array<std::array<float, 3>, 4> p = {
      {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}}};
  const std::array<std::array<std::size_t, 3>, 4> faces = {
      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  std::string stl(80, ' ');
  stl += std::string("\4\0\0\0", 4);
  for (const auto& face : faces) {
    stl += std::string(12, '\0');
    for (const std::size_t i : face) stl.append(reinterpret_cast<const char*>(p[i].data()), 12);
    stl += std::string(2, '\0');
  }
  Write("mesh.stl", stl);
  EXPECT_EQ(Error(), "");
}

TEST(Wiring, AFixtureInsideTheObjectIsRefusedAtItsPlace) {
  const std::string text =
      Box() + "environment:\n  fixtures:\n    - {shape: box, size: [1, 1, 1], xyz: [0.5, 0, 0]}\n";
  const std::string error = ErrorOf(text);
  EXPECT_EQ(error.find(PlaceIn(text, "{shape: box, size: [1, 1, 1]") +
                       "environment.fixtures.0: at cobot.posture, the object is "),
            0u)
      << error;
  EXPECT_NE(error.find(" mm inside this fixture. Move the fixture, or change cobot.posture."),
            std::string::npos)
      << error;
}

}  // namespace
}  // namespace predictor
