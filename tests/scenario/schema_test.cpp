#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include "core/text.h"
#include "fixture.h"
#include "json_schema.h"
#include "scenario/actions/action.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"
#include "scenario/yaml_scalar.h"
#include "support/soak.h"

namespace predictor {
namespace {

const Json& Schema() {
  static const Json schema = Json::parse(ScenarioSchema());
  return schema;
}

// Returns a tree in the form in which an editor's YAML reader sees it.
Json ToJson(const YamlNode& node) {
  using Kind = YamlNode::Kind;
  Json json;
  if (node.kind == Kind::kList) json = Json::array();
  if (node.kind == Kind::kMap) json = Json::object();
  for (const YamlNode& item : node.items) {
    if (node.kind == Kind::kList) json.push_back(ToJson(item));
    if (node.kind == Kind::kMap) json[item.key] = ToJson(item);
  }
  if (node.kind != Kind::kScalar) return json;
  if (KindOf(node) == ScalarKind::kString) return node.text;
  if (KindOf(node) == ScalarKind::kBool) return node.text == "true";
  const bool is_whole = node.text.find_first_not_of("+-0123456789") == std::string::npos;
  double number = 0;
  ReadNumber(node.text, &number);
  if (is_whole && number >= 0 && number <= 1.8446744073709552e19) return std::stoull(node.text);
  if (is_whole && number < 0 && number > -9e18) return std::stoll(node.text);
  return number;
}

// Returns a tree that contains each possible part of a scenario once, so that every leaf has an
// instance.
YamlNode FullTree() {
  return ScenarioTree(Fixture(
      {"rig.loop={}", "rendering.link_pairs=[[a, b]]", "object.attachment.range=[-1, 1]",
       "rendering.lead=0.02", "device.arms.left.posture=[0, 1]",
       "device.arms.left.velocity_limit=[1, 2]",
       "operator.script=[{action: hold}, {action: push, force: [1, 2, 3]}]",
       "cobot.controller.trajectory=[{time: 1}]", "handles.right=null", "device.arms.right=null",
       "perturbation={consent: true}", "cobot.payload={mass: 1}"}));
}

bool SchemaAccepts(const YamlNode& tree) { return Validates(Schema(), ToJson(tree)); }

bool LoaderAccepts(const YamlNode& tree) {
  Problems problems;
  ReadFields(tree, &problems);
  return problems.empty();
}

TEST(Schema, AcceptsWhatIsLoadedAndSaved) {
  EXPECT_TRUE(SchemaAccepts(FullTree()));
  EXPECT_TRUE(SchemaAccepts(ParseYaml(FixtureText(), "fixture")));
  EXPECT_TRUE(SchemaAccepts(ParseYaml(SaveScenario(Fixture()), "saved")));
  EXPECT_TRUE(LoaderAccepts(FullTree()));
}

// The second line of each scenario must refer to this file, because editors use this line.
TEST(Schema, EqualsTheFileInTheScenariosFolder) {
  std::ifstream file(PREDICTOR_SOURCE_DIR "/scenarios/scenario.schema.json");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_TRUE(text.str() == ScenarioSchema())
      << "Regenerate it: predictor schema scenario > scenarios/scenario.schema.json";
}

TEST(Schema, IsDraft07AndDescribesEachKey) {
  EXPECT_EQ(Schema()["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_EQ(Schema()["$id"], "urn:predictor:schema:scenario");
  std::function<int(const Json&)> count = [&](const Json& schema) {
    int keys = 0;
    if (schema.contains("properties")) {
      for (const auto& [key, property] : schema["properties"].items()) {
        EXPECT_TRUE(property.contains("description") && !property["description"].empty()) << key;
        keys += 1 + count(property);
      }
      EXPECT_EQ(schema["additionalProperties"], false);
    }
    for (const char* inner : {"items"}) {
      if (schema.contains(inner)) keys += count(schema[inner]);
    }
    if (schema.contains("anyOf")) {
      for (const Json& each : schema["anyOf"]) keys += count(each);
    }
    return keys;
  };
  Json described = Schema();
  described.erase("anyOf");  // the keys that are required if the scenario extends no other
  EXPECT_GT(count(described), 200);
}

TEST(Schema, DefaultsAreThoseOfTheStructs) {
  const Scenario standard;
  const Json& safety = Schema()["properties"]["safety"]["properties"];
  EXPECT_EQ(safety["stop_jerk"]["default"], standard.safety.stop_jerk);
  EXPECT_EQ(safety["oscillation"]["properties"]["low"]["default"], standard.safety.oscillation.low);
  EXPECT_EQ(Schema()["properties"]["rendering"]["properties"]["lead"]["default"], "auto");
  EXPECT_FALSE(Schema()["properties"]["cobot"]["properties"]["model"].contains("default"));
}

// Calls `visit` for every node of a tree.
void ForEach(YamlNode* node, const std::string& path,
             const std::function<void(YamlNode*, const std::string&)>& visit) {
  visit(node, path);
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    YamlNode* item = &node->items[i];
    ForEach(item, path + "." + (item->key.empty() ? std::to_string(i) : item->key), visit);
  }
}

// These values are valid in some places and invalid in others. They include the ends of ranges and
// values beyond these ends, other types, other lengths, and the words of every choice.
constexpr const char* kOthers =
    "0;-1;1;2;1e-9;-1e-9;0.3;0.5;3;3.2;3.3;7;10;11;20;21;30;64;100;101;1000;1001;10001;100001;"
    "86400;"
    "86401;1e6;1.1e6;-1e300;18446744073709551615;1.5;true;false;null;word;auto;\"\";\"5\";[];{};[1]"
    ";"
    "[1, 2];[1, 2, 3];[1, 2, -3];[0, 0, 0];[1, 2, 3, 4];[1, 2, 3, 4, 5, 6];"
    "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1];[a];[a, b];[[a, b]];[[a]];[[a, 1]];[{}];[{time: 1}];"
    "[{action: hold}];[{action: hold, x: 1}];left;direct;box;fixed;push;virtual;circle;"
    "3 deg;-3 deg;deg;3 degrees;\"3 deg\";1e-1 deg;[1 deg, 2 deg, -3 deg];[3deg, 1, 2];"
    "{xyz: [0, 0, 0]};{xyz: [0, 0]};{unknown: 1}";

// Replaces each value of a full scenario with each of many other values, or with every third in the
// short test. Schema and loader must accept the same values. Neither the schema nor ReadFields
// detects a value that is invalid only because it contradicts another value.
TEST(Schema, JudgesEveryValueAsTheLoaderDoesSoak) {
  std::vector<std::string> others;
  std::istringstream lines(kOthers);
  for (std::string other; std::getline(lines, other, ';');) others.push_back(other);
  YamlNode tree = FullTree();
  Json json = ToJson(tree);
  const std::size_t step = InFull() ? 1 : 3;
  int accepted = 0, refused = 0;
  std::set<std::string> paths;
  ForEach(&tree, "", [&](YamlNode* node, const std::string& path) {
    if (path.empty() || path == ".handles") return;  // only the schema requires at least one handle
    std::string pointer = path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    Json& part = json[Json::json_pointer(pointer)];
    const YamlNode before = *node;
    const Json part_before = part;
    for (std::size_t k = paths.size() % step; k < others.size(); k += step) {
      const std::string& other = others[k];
      YamlNode value = ParseYaml(other, "other");
      value.key = before.key;
      *node = value;
      part = ToJson(value);
      const bool by_loader = LoaderAccepts(tree), by_schema = Validates(Schema(), json);
      EXPECT_EQ(by_loader, by_schema) << path << " = " << other;
      (by_loader ? accepted : refused) += 1;
    }
    *node = before;
    part = part_before;
    paths.insert(path);
  });
  EXPECT_GT(paths.size(), 200u);
  EXPECT_GT(accepted * static_cast<int>(step), 1000);
  EXPECT_GT(refused * static_cast<int>(step), 5000);
}

TEST(Schema, RefusesUnknownAndMissingKeysWhereTheLoaderDoes) {
  YamlNode tree = FullTree();
  ForEach(&tree, "", [&](YamlNode* node, const std::string& path) {
    if (node->kind != YamlNode::Kind::kMap) return;
    const YamlNode before = *node;
    YamlNode extra = ParseYaml("1", "other");
    extra.key = "zzz";
    node->items.push_back(extra);
    EXPECT_FALSE(LoaderAccepts(tree)) << path;
    EXPECT_FALSE(SchemaAccepts(tree)) << path;
    for (std::size_t i = 0; i < before.items.size(); ++i) {
      *node = before;
      node->items.erase(node->items.begin() + static_cast<std::ptrdiff_t>(i));
      const std::string& key = before.items[i].key;
      // the checks need these keys
      if (path.empty() && (key == "object" || key == "handles")) continue;
      EXPECT_EQ(LoaderAccepts(tree), SchemaAccepts(tree)) << path << " without " << key;
    }
    *node = before;
  });
}

TEST(Schema, HasAnAlternativePerAction) {
  const auto judge = [](const std::string& entry, bool expected) {
    YamlNode tree = ParseYaml(FixtureText(), "fixture");
    ApplyOverride("operator.script=[" + entry + "]", &tree);
    EXPECT_EQ(LoaderAccepts(tree), expected) << entry;
    EXPECT_EQ(SchemaAccepts(tree), expected) << entry;
  };
  judge("{action: grip}", true);
  judge("{action: grip, start: 2, hand: left}", true);
  judge("{action: grip, by: [0, 0, 1]}", false);
  judge("{action: move}", false);
  judge("{action: move, by: [0, 0, 1]}", true);
  judge("{action: put_down}", true);
  judge("{action: nope}", false);
  judge("{start: 1}", false);
  judge("{start: 1, duration: 2}", false);
  const Json& kinds = Schema()["properties"]["operator"]["properties"]["script"]["items"]["anyOf"];
  ASSERT_EQ(kinds.size(), Actions().size());
  EXPECT_EQ(kinds[0]["title"], "circle");
  EXPECT_EQ(kinds[0]["properties"]["start"]["default"], 0);
  EXPECT_EQ(kinds[0]["properties"]["period"]["default"], 8);
}

TEST(Schema, HasAnAlternativePerController) {
  const auto judge = [](const std::string& controller, bool expected) {
    YamlNode tree = ParseYaml(FixtureText(), "fixture");
    ApplyOverride("cobot.controller=" + controller, &tree);
    EXPECT_EQ(LoaderAccepts(tree), expected) << controller;
    EXPECT_EQ(SchemaAccepts(tree), expected) << controller;
  };
  judge("{}", true);
  judge("{damping_ratio: 0.5}", true);
  judge("{joint_stiffness: 3}", false);
  judge("{type: cartesian_impedance, joint_stiffness: 3}", false);
  judge("{type: joint_impedance, joint_stiffness: 3}", true);
  judge("{type: joint_impedance, damping_ratio: 0.5}", false);
  judge("{type: gravity_compensation}", true);
  judge("{type: gravity_compensation, trajectory: []}", false);
  judge("{type: nope}", false);
  // The extended scenario may have set the type.
  EXPECT_TRUE(SchemaAccepts(
      ParseYaml("{extends: a.yaml, cobot: {controller: {joint_stiffness: 3}}}", "extending")));
  EXPECT_FALSE(SchemaAccepts(ParseYaml(
      "{extends: a.yaml, cobot: {controller: {joint_stiffness: 3, damping_ratio: 1}}}", "both")));
}

// ---- machine files ------------------------------------------------------------------------------

const Json& OfMachines() {
  static const Json schema = Json::parse(MachineSchema());
  return schema;
}

std::string ContentOf(const std::string& file) {
  std::ifstream in(std::string(PREDICTOR_SOURCE_DIR) + "/" + file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(MachineSchema, AcceptsWhatIsReadAndWritten) {
  const std::string text = ContentOf("docs/rig-without-arms.yaml");
  EXPECT_TRUE(Validates(OfMachines(), ToJson(ParseYaml(text, "read"))));
  Machine machine = ParseMachine(text, "lab.yaml");
  machine.left->commissioned.emplace();
  machine.left->connection.collision.emplace();
  YamlNode saved = ParseYaml(SaveMachine(machine), "saved");
  EXPECT_TRUE(Validates(OfMachines(), ToJson(saved)));
  ForEach(&saved, "", [&](YamlNode* node, const std::string& path) {
    if (node->kind != YamlNode::Kind::kMap) return;
    YamlNode extra = ParseYaml("1", "other");
    extra.key = "zzz";
    node->items.push_back(extra);
    EXPECT_FALSE(Validates(OfMachines(), ToJson(saved))) << path;
    node->items.pop_back();
  });
}

TEST(MachineSchema, HasTheDefaultsOfTheStructs) {
  const Json& left = OfMachines()["properties"]["arms"]["properties"]["left"]["anyOf"][1];
  const Json& arm = left["properties"]["arm"]["properties"];
  EXPECT_EQ(arm["sample_rate"]["default"], ArmSpec().sample_rate);
  EXPECT_EQ(arm["sensor"]["properties"]["delay"]["default"], SensorSpec().delay);
  EXPECT_FALSE(arm["model"].contains("default"));
  EXPECT_EQ(OfMachines()["required"], (Json{"predictor_machine", "arms"}));
}

// machine_test.cpp compares each of these limits with docs/reference/machine-file.md.
TEST(MachineSchema, HasAsManyLimitsAsTheDocument) {
  EXPECT_EQ(OfMachines()["properties"]["limits"]["properties"].size(), 22u);
}

}  // namespace
}  // namespace predictor
