// The supplied layout may show only data that the server publishes, so that no panel requests data
// that does not exist.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include "core/status.h"
#include "scenario/scenario_io.h"
#include "viewer/foxglove.h"

namespace predictor::viewer {
namespace {

Json Layout() {
  std::ifstream file(std::string(PREDICTOR_SOURCE_DIR) + "/docs/foxglove-layout.json");
  return Json::parse(file);
}

std::map<std::string, Json> Schemas() {
  std::map<std::string, Json> schemas;
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  for (const FoxgloveChannel& channel : FoxgloveChannels(scenario, {0.5, 0, 0.3}))
    schemas[channel.topic] = channel.schema;
  return schemas;
}

// Returns the JSON type of a message path such as /run.harder.cause, or an empty text if the path
// does not exist.
std::string TypeAt(const std::map<std::string, Json>& schemas, const std::string& path) {
  std::istringstream parts(path);
  std::string part;
  std::getline(parts, part, '.');
  const auto topic = schemas.find(part);
  if (topic == schemas.end()) return "";
  Json schema = topic->second;
  while (std::getline(parts, part, '.')) {
    if (!schema.contains("properties") || !schema["properties"].contains(part)) return "";
    schema = Json(schema["properties"][part]);
  }
  return schema["type"];
}

bool IsNumber(const std::string& type) { return type == "number" || type == "integer"; }

// Returns the panels that occur in the layout's tree.
std::set<std::string> Placed(const Json& node) {
  if (node.is_string()) return {node.get<std::string>()};
  std::set<std::string> all = Placed(node["first"]);
  all.merge(Placed(node["second"]));
  return all;
}

TEST(FoxgloveLayout, PathsAreFoundAsAdvertised) {
  const auto schemas = Schemas();
  ASSERT_EQ(TypeAt(schemas, "/run.no_such_field"), "");
  ASSERT_EQ(TypeAt(schemas, "/no_such_topic.state"), "");
  const Json layout = Layout();
  int plots = 0;
  for (const auto& [id, panel] : layout["configById"].items()) {
    const std::string kind = id.substr(0, id.find('!'));
    if (kind == "Plot") {
      ++plots;
      for (const Json& series : panel["paths"])
        EXPECT_TRUE(IsNumber(TypeAt(schemas, series["value"]))) << id << series;
    } else if (kind == "StateTransitions") {
      for (const Json& series : panel["paths"]) {
        const std::string type = TypeAt(schemas, series["value"]);
        EXPECT_TRUE(type == "string" || type == "integer") << id << series;
      }
    } else if (kind == "Indicator") {
      EXPECT_EQ(TypeAt(schemas, panel["path"]), "string") << id;
    } else if (kind == "RawMessages") {
      EXPECT_EQ(TypeAt(schemas, panel["topicPath"]), "object") << id;
    } else if (kind == "3D") {
      for (const auto& [topic, settings] : panel["topics"].items())
        EXPECT_TRUE(schemas.contains(topic)) << id << topic;
    } else {
      ADD_FAILURE() << id << ": this test does not support panels of this type";
    }
  }
  EXPECT_EQ(plots, 5);
}

TEST(FoxgloveLayout, ShowsTheReasonForPowerOffAfterAStop) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  TickRecord record = {};
  record.cause = StopCause::kForce;
  for (const FoxgloveChannel& channel : FoxgloveChannels(scenario, {0.5, 0, 0.3})) {
    if (channel.topic != "/run") continue;
    EXPECT_EQ(channel.message(record, 1)["harder"]["cause"], "none");
    record.harder = {StopCause::kStale, 0, Quantity::kArmAge, 1, {}, 0.021, 0.02};
    const Json reported = channel.message(record, 1);
    EXPECT_EQ(reported["cause"], "force");
    EXPECT_EQ(reported["harder"]["cause"], "stale");
    EXPECT_EQ(reported["harder"]["value"], 0.021);
    EXPECT_EQ(reported["harder"]["limit"], 0.02);
    for (const auto& [key, value] : reported.items())
      EXPECT_TRUE(channel.schema["properties"].contains(key)) << key;
    return;
  }
  FAIL() << "no /run";
}

TEST(FoxgloveLayout, EveryPanelIsPlacedOnce) {
  const Json layout = Layout();
  std::set<std::string> configured;
  for (const auto& [id, panel] : layout["configById"].items()) configured.insert(id);
  EXPECT_EQ(Placed(layout["layout"]), configured);
}

// The 3D view must use a frame that /tf and /scene contain.
TEST(FoxgloveLayout, TheViewsFrameExists) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  TickRecord record = {};
  std::set<std::string> frames;
  const Json tf = FoxgloveChannels(scenario, {0.5, 0, 0.3})[0].message(record, 1);
  for (const Json& transform : tf["transforms"]) {
    frames.insert(transform["parent_frame_id"]);
    frames.insert(transform["child_frame_id"]);
  }
  const Json layout = Layout();
  const Json& view = layout["configById"]["3D!scene"];
  EXPECT_TRUE(frames.contains(view["followTf"]));
  for (const auto& [id, layer] : view["layers"].items())
    EXPECT_TRUE(frames.contains(layer["frameId"])) << id;
}

TEST(FoxgloveLayout, TheIndicatorKnowsTheStatesByName) {
  std::set<std::string> names;
  for (int s = 0; s < kRunStates; ++s) names.insert(Name(static_cast<RunState>(s)));
  const Json layout = Layout();
  for (const Json& rule : layout["configById"]["Indicator!state"]["rules"])
    EXPECT_TRUE(names.contains(rule["rawValue"])) << rule;
}

}  // namespace
}  // namespace predictor::viewer
