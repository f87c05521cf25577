// Each controller and each action has its own parameters. The program must refuse the parameters of
// another controller or action.
#include "scenario/own_parameters.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/text.h"
#include "fixture.h"
#include "json_schema.h"
#include "scenario/kind_groups.h"
#include "scenario/problems.h"
#include "simulation/controller.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

// This test also makes the linker keep the module that declares the controllers.
TEST(OwnParameters, AreThoseOfTheSimulationsControllers) {
  EXPECT_EQ(NamesOf(Controllers()), ControllerNames());
}

std::string ParameterOf(const Scenario& scenario, const std::string& key) {
  const YamlNode* node = scenario.cobot.controller.parameters.Find(key);
  return node ? node->text : "none";
}

TEST(OwnParameters, HaveTheirDefaults) {
  const Scenario cartesian = Fixture();
  EXPECT_EQ(ParameterOf(cartesian, "posture_stiffness"), "10");
  EXPECT_EQ(ParameterOf(cartesian, "joint_stiffness"), "none");
  const std::string saved = SaveScenario(Fixture({"cobot.controller={type: joint_impedance}"}));
  EXPECT_NE(saved.find("joint_damping_ratio: 0.7"), std::string::npos);
  EXPECT_NE(saved.find("# [N·m/rad or N/m] stiffness for all joints"), std::string::npos);
  EXPECT_EQ(saved.find("posture_stiffness"), std::string::npos);
  EXPECT_NE(SaveScenario(Scenario()).find("posture_stiffness: 10"), std::string::npos);
}

std::string ErrorOfController(const std::string& controller) {
  return ErrorOf("predictor: 1\ncobot:\n  model: a\n  end_effector: b\n  controller:\n" +
                 controller + "object: {model: c}\nhandles: {left: {}}\nmode: direct\n");
}

TEST(OwnParameters, OfAnotherKindAreRefused) {
  EXPECT_EQ(
      ErrorOfController("    type: joint_impedance\n    damping_ratio: 0.7\n"),
      "box.yaml:7:5: cobot.controller.damping_ratio has no effect in joint_impedance; it is a "
      "parameter of cartesian_impedance. Remove it, or set another type.");
  EXPECT_EQ(
      ErrorOfController("    joint_stiffness: 100\n"),  // refused although it is the default
      "box.yaml:6:5: cobot.controller.joint_stiffness has no effect in cartesian_impedance; it "
      "is a parameter of joint_impedance. Remove it, or set another type.");
  EXPECT_NE(ErrorOfController("    type: gravity_compensation\n    trajectory: []\n"), "");
}

TEST(OwnParameters, AreSuggestedIfMisspelt) {
  EXPECT_EQ(ErrorOfController("    dampin_ratio: 0.7\n"),
            "box.yaml:6:5: \"dampin_ratio\" is not a key of cobot.controller. Did you mean "
            "damping_ratio?");
  EXPECT_EQ(ErrorOfController("    type: joint_impedence\n    joint_stiffness: 1\n"),
            "box.yaml:6:11: cobot.controller.type is \"joint_impedence\"; it must be one of: " +
                Join(ControllerNames()) + ". Did you mean joint_impedance?");
}

TEST(OwnParameters, HaveRanges) {
  EXPECT_EQ(
      ErrorOfController("    stiffness: {translation: [1, 2, -3]}\n"),
      "box.yaml:6:37: cobot.controller.stiffness.translation.2 is -3 N/m; it must be from 0 to "
      "1e+05 N/m.");
}

TEST(OwnParameters, MayBeAnglesInDegrees) {
  const Scenario scenario =
      Fixture({"cobot.controller.trajectory=[{time: 1, rpy: [0, 0, 180 deg]}]"});
  const YamlNode& waypoint = scenario.cobot.controller.parameters.Find("trajectory")->items[0];
  EXPECT_EQ(std::stod(waypoint.Find("rpy")->items[2].text), std::numbers::pi);
}

// The test sets the value in the same way as a file that extends another one.
TEST(OwnParameters, OfTheFormerTypeAreDroppedByAnOverride) {
  const std::string type = "cobot.controller.type=joint_impedance";
  EXPECT_EQ(ParameterOf(Fixture({type, "cobot.controller.joint_stiffness=200"}), "joint_stiffness"),
            "200");
  EXPECT_NE(ErrorOf(FixtureText(), {type, "cobot.controller.damping_ratio=1"}), "");
  EXPECT_NE(ErrorOf(FixtureText(), {"cobot.controller.posture_stiffness=1", type}), "");
}

// ---- a kind with a required parameter -----------------------------------------------------------

struct ViscosityParameters {
  double viscosity = 0;
};
template <class V>
void Fields(V& v, ViscosityParameters& p) {
  v("viscosity", p.viscosity, Required(Number("N·m·s/rad", "of each joint", From(0, 10))));
}
const ParameterKind kViscous = {"viscous", "resists motion", NewParameters<ViscosityParameters>};
const ParameterKind kPlain = {"plain", "does nothing", NewParameters<NoParameters>};
const ParameterKind* kKinds[] = {&kPlain, &kViscous};

// At the end, the program's own controllers are registered again.
class OtherControllers : public testing::Test {
 protected:
  OtherControllers() { DeclareControllers(kKinds); }
  ~OtherControllers() override { DeclareControllers(before_); }
  ParameterKinds before_ = Controllers();
};

TEST_F(OtherControllers, MayRequireAParameter) {
  EXPECT_EQ(ErrorOfController("    type: viscous\n"),
            "box.yaml:6:5: cobot.controller.viscosity is missing. Give a value (of each joint).");
  EXPECT_EQ(ErrorOfController("    type: viscous\n    viscosity: 1\n"), "");
}

TEST_F(OtherControllers, AreAlternativesInTheSchema) {
  const Json schema = Json::parse(ScenarioSchema());
  const auto accepts = [&](const Json& controller) {
    return Validates(
        schema, {{"predictor", 1},
                 {"cobot", {{"model", "a"}, {"end_effector", "b"}, {"controller", controller}}},
                 {"object", Json::object()},
                 {"handles", {{"left", Json::object()}}}});
  };
  EXPECT_TRUE(accepts({{"type", "viscous"}, {"viscosity", 1}}));
  EXPECT_FALSE(accepts({{"type", "viscous"}}));
  EXPECT_TRUE(accepts({{"type", "plain"}}));
  EXPECT_FALSE(accepts({{"type", "plain"}, {"viscosity", 1}}));
  const auto& kinds = schema["properties"]["cobot"]["properties"]["controller"]["anyOf"];
  ASSERT_EQ(kinds.size(), 2u);
  EXPECT_EQ(kinds[1]["title"], "viscous");
  EXPECT_EQ(kinds[1]["properties"]["type"]["enum"], Json({"viscous"}));
  EXPECT_EQ(kinds[1]["properties"]["viscosity"]["description"], "[N·m·s/rad] of each joint");
  EXPECT_FALSE(kinds[0]["properties"].contains("viscosity"));
}

class NoControllers : public OtherControllers {
 protected:
  NoControllers() { DeclareControllers({}); }
};

TEST_F(NoControllers, KeepParametersAsTheyAreGiven) {
  const Scenario scenario = Fixture({"cobot.controller={type: any, viscosity: 3}"});
  EXPECT_EQ(ParameterOf(scenario, "viscosity"), "3");
  EXPECT_EQ(SaveScenario(ParseScenario(SaveScenario(scenario), "saved", kData)),
            SaveScenario(scenario));
}

// ---- actions of the operator --------------------------------------------------------------------

// The script of this scenario grips, moves and pushes.
TEST(ActionParameters, OfTheFormerActionAreDroppedByAnOverride) {
  const std::string action = "operator.script.1.action=rotate";
  const Scenario scenario = Fixture(
      {action, "operator.script.1.rotate_by=[0, 0, 90 deg]", "operator.script.1.duration=3"});
  const YamlNode& rotate = scenario.operator_.script[1].parameters;
  EXPECT_EQ(rotate.Find("by"), nullptr);
  EXPECT_EQ(rotate.Find("duration")->text, "3");
  EXPECT_EQ(std::stod(rotate.Find("rotate_by")->items[2].text), std::numbers::pi / 2);
  EXPECT_NE(ErrorOf(FixtureText(), {action}).find("operator.script.1.rotate_by is missing"),
            std::string::npos);
}

TEST(ActionParameters, OfAMisspeltActionAreNotReported) {
  EXPECT_EQ(
      ErrorOf(FixtureText(), {"operator.script=[{acton: move, by: [0, 0, 1], by_: 2}]"}),
      "--set operator.script:1:3: \"acton\" is not a key of operator.script.0. Did you mean "
      "action?\n--set operator.script:1:31: \"by_\" is not a key of operator.script.0. Did you "
      "mean by?");
}

TEST(KindGroups, AreThoseOfTheTree) {
  YamlNode tree = ParseYaml(FixtureText(), "fixture");
  std::vector<std::string> paths;
  for (const KindGroup& group : KindGroups(&tree)) paths.push_back(group.path + " " + group.key);
  EXPECT_EQ(paths, (std::vector<std::string>{"cobot.controller type", "operator.script.0 action",
                                             "operator.script.1 action", "operator.script.2 action",
                                             "operator.script.3 action"}));
  for (const char* text :
       {"{}", "{cobot: 1, operator: {script: 2}}", "{cobot: [], operator: []}"}) {
    YamlNode broken = ParseYaml(text, "broken");
    EXPECT_TRUE(KindGroups(&broken).empty()) << text;
  }
}

// ---- tasks and limits of rendering --------------------------------------------------------------

struct HeightParameters {
  double height = 0.2;
};
template <class V>
void Fields(V& v, HeightParameters& p) {
  v("height", p.height, Number("m", "of the handles, at least", From(0, 2)));
}
const ParameterKind kHeight = {"height_limit", "keeps handles up", NewParameters<HeightParameters>};
const ParameterKind* kParts[] = {&kPlain, &kHeight};

class RenderingPart : public testing::Test {
 protected:
  RenderingPart() { DeclareRenderingParts(kParts); }
  ~RenderingPart() override { DeclareRenderingParts(before_); }
  ParameterKinds before_ = RenderingParts();
};

TEST_F(RenderingPart, HasAGroupOfItsOwn) {
  const auto height = [](const Scenario& scenario) {
    Problems problems;
    const auto own = ParametersOfPart(kHeight, scenario.rendering.parts, "rendering", &problems);
    problems.ThrowIfAny();
    return ValueOf<HeightParameters>(*own).height;
  };
  EXPECT_EQ(height(Scenario()), 0.2);
  EXPECT_EQ(height(Fixture()), 0.2);
  const Scenario scenario = Fixture({"rendering.height_limit.height=0.5"});
  EXPECT_EQ(height(scenario), 0.5);
  const std::string saved = SaveScenario(scenario);
  EXPECT_NE(saved.find("height: 0.5"), std::string::npos);
  EXPECT_EQ(saved.find("plain"), std::string::npos);
  EXPECT_EQ(SaveScenario(ParseScenario(saved, "saved", kData)), saved);
}

TEST_F(RenderingPart, RefusesWhatItDoesNotHave) {
  EXPECT_EQ(ErrorOfOverride("rendering.height_limit.heightt=1"),
            "--set rendering.height_limit.heightt: \"heightt\" is not a key of "
            "rendering.height_limit. Did you mean height?");
  EXPECT_NE(ErrorOfOverride("rendering.height_limit.height=3").find("must be from 0 to 2 m"),
            std::string::npos);
  EXPECT_NE(ErrorOfOverride("rendering.plain={}"), "");
  const Json schema = Json::parse(ScenarioSchema());
  const Json& rendering = schema["properties"]["rendering"]["properties"];
  EXPECT_EQ(rendering["height_limit"]["properties"]["height"]["default"], 0.2);
  EXPECT_FALSE(rendering.contains("plain"));
}

// ---- earlier recordings -------------------------------------------------------------------------

TEST(OwnParameters, OfOtherKindsAreRemovedFromEarlierRecordings) {
  YamlNode group =
      ParseYaml("{type: joint_impedance, joint_stiffness: 3, trajectory: [], x: 1}", "f");
  const KindGroup controller = {"cobot.controller", "type", Controllers(), &group};
  EXPECT_TRUE(RemoveForeignParameters(controller));
  EXPECT_EQ(group.items.size(), 3u);
  EXPECT_EQ(group.Find("trajectory"), nullptr);
  EXPECT_FALSE(RemoveForeignParameters(controller));
  YamlNode script = ParseYaml(
      "{operator: {script: [{action: grip, start: 1, duration: 2, hand: left, rise_time: 0.12}]}}",
      "f");
  for (const KindGroup& entry : KindGroups(&script)) EXPECT_TRUE(RemoveForeignParameters(entry));
  EXPECT_EQ(script.items[0].items[0].items[0].items.size(), 4u);
}

}  // namespace
}  // namespace predictor
