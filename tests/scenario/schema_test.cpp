#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

#include "fixture.h"
#include "json_schema.h"
#include "scenario/scenario_tree.h"
#include "scenario/yaml_scalar.h"

namespace predictor {
namespace {

const Json& Schema() {
  static const Json schema = Json::parse(ScenarioSchema());
  return schema;
}

// A tree as an editor's YAML reader would see it.
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

// Everything that a scenario can hold is there once, so that every leaf has an instance.
YamlNode FullTree() {
  return ScenarioTree(Fixture(
      {"rig.loop={}", "rendering.link_pairs=[[a, b]]", "object.attachment.range=[-1, 1]",
       "rendering.lead=0.02", "device.arms.left.posture=[0, 1]",
       "device.arms.left.velocity_limit=[1, 2]", "operator.script=[{action: hold}]",
       "cobot.controller.trajectory=[{time: 1}]", "handles.right=null", "device.arms.right=null"}));
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

TEST(Schema, IsDraft07AndDescribesEachKey) {
  EXPECT_EQ(Schema()["$schema"], "http://json-schema.org/draft-07/schema#");
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
  EXPECT_GT(count(Schema()), 200);
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

// Values that are good somewhere and bad elsewhere: ends of ranges and beyond, other types, other
// lengths, words of every choice.
constexpr const char* kOthers =
    "0;-1;1;2;1e-9;-1e-9;0.3;0.5;3;3.2;3.3;7;10;11;20;21;30;64;100;101;1000;1001;10001;100001;"
    "86400;"
    "86401;1e6;1.1e6;-1e300;18446744073709551615;1.5;true;false;null;word;auto;\"\";\"5\";[];{};[1]"
    ";"
    "[1, 2];[1, 2, 3];[1, 2, -3];[0, 0, 0];[1, 2, 3, 4];[1, 2, 3, 4, 5, 6];"
    "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1];[a];[a, b];[[a, b]];[[a]];[[a, 1]];[{}];[{time: 1}];"
    "[{action: hold}];[{action: hold, x: 1}];left;direct;box;fixed;push;virtual;circle;"
    "{xyz: [0, 0, 0]};{xyz: [0, 0]};{unknown: 1}";

// Replaces each value of a full scenario by each of many others: both must judge alike. (What only
// contradicts another value is no matter of the schema, nor of ReadFields.)
TEST(Schema, JudgesEveryValueAsTheLoaderDoes) {
  std::vector<std::string> others;
  std::istringstream lines(kOthers);
  for (std::string other; std::getline(lines, other, ';');) others.push_back(other);
  YamlNode tree = FullTree();
  Json json = ToJson(tree);
  int accepted = 0, refused = 0;
  std::set<std::string> paths;
  ForEach(&tree, "", [&](YamlNode* node, const std::string& path) {
    if (path.empty() || path == ".handles") return;  // the schema alone asks for one handle
    std::string pointer = path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    Json& part = json[Json::json_pointer(pointer)];
    const YamlNode before = *node;
    const Json part_before = part;
    for (const std::string& other : others) {
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
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 5000);
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
      if (path.empty() && (key == "object" || key == "handles")) continue;  // needed by the checks
      EXPECT_EQ(LoaderAccepts(tree), SchemaAccepts(tree)) << path << " without " << key;
    }
    *node = before;
  });
}

}  // namespace
}  // namespace predictor
