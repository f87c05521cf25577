#include "viewer/scene_description.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/action_time.h"
#include "scenario/actions/action.h"
#include "scenario/obstacle_events.h"
#include "scenario/operating_rules.h"
#include "scenario/own_parameters.h"
#include "scenario/paths.h"
#include "scenario/stance.h"

namespace predictor::viewer {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json ToJson(const Pose& X) {
  return {{"p", ToJson(X.p)}, {"q", {X.q.w(), X.q.x(), X.q.y(), X.q.z()}}};
}

const char* Name(Shape shape) {
  switch (shape) {
    case Shape::kBox:
      return "box";
    case Shape::kCylinder:
      return "cylinder";
    default:
      return "sphere";
  }
}

// Describes a cobot or an arm. The description lists no links to remove, because ReadUrdf has
// already removed them.
Json DescribeRobot(const std::string& model, const std::vector<std::string>& remove_links,
                   const Pose& X_WB, const std::string& end_effector,
                   const std::filesystem::path& folder, AssetStore* assets) {
  const UrdfModel urdf = ReadUrdf(ResolveModelPath(model, folder), remove_links, folder);
  const auto robot = RobotModel::Build(urdf, X_WB);
  Json joints = Json::array();
  for (int j = 0; j < robot->dof(); ++j) joints.push_back(robot->joint_name(j));
  return {{"urdf", assets->AddModel(urdf)},
          {"base", ToJson(X_WB)},
          {"joints", joints},
          {"remove_links", Json::array()},
          {"end_effector", end_effector}};
}

Json DescribeArm(const Scenario& scenario, int hand, AssetStore* assets) {
  const auto& arm = hand == 0 ? scenario.device.left : scenario.device.right;
  if (!arm || !scenario.Has(hand)) return nullptr;
  Json json = DescribeRobot(arm->model, arm->remove_links, scenario.X_WB(hand), arm->end_effector,
                            scenario.file.parent_path(), assets);
  json["handle"] = ToJson(arm->handle.ToPose());
  return json;
}

// Describes a body, which is a model or a primitive.
Json DescribeBody(const std::string& model, const std::optional<PrimitiveSpec>& primitive,
                  const Scenario& scenario, AssetStore* assets) {
  if (!model.empty())
    return {{"urdf", assets->AddModel(ReadUrdf(ResolveModelPath(model, scenario.folder()), {},
                                               scenario.folder()))}};
  const PrimitiveSpec body = primitive.value_or(PrimitiveSpec());
  return {{"shape", Name(body.shape)}, {"size", ToJson(body.size)}};
}

Json DescribeMovables(const Scenario& scenario, AssetStore* assets) {
  Json json = Json::array();
  for (const MovableSpec& movable : scenario.environment.objects) {
    Json body = DescribeBody(movable.model, movable.primitive, scenario, assets);
    body["name"] = Printable(movable.name);
    if (movable.model.empty()) body["color"] = ToJson(movable.color);
    json.push_back(std::move(body));
  }
  return json;
}

// Returns whether a parameter concerns the cobot's controller although this controller has nothing
// that it could change.
bool HasNoEffect(Parameter parameter, const Scenario& scenario) {
  if (parameter != Parameter::kStiffnessTranslation && parameter != Parameter::kStiffnessRotation &&
      parameter != Parameter::kDampingRatio)
    return false;
  const ParameterKind* kind = FindKind(Controllers(), scenario.cobot.controller.type);
  return kind != nullptr && !kind->is_tunable;
}

Json DescribeParameters(const Scenario& scenario) {
  Json json = Json::object();
  for (int k = 0; k < kParameters; ++k) {
    const auto parameter = static_cast<Parameter>(k);
    if (HasNoEffect(parameter, scenario)) continue;
    const ParameterRange range = RangeOf(scenario, parameter);
    json[predictor::Name(parameter)] = {
        {"min", range.min}, {"max", range.max}, {"value", range.start}};
  }
  return json;
}

Json DescribeScript(const Scenario& scenario, double facing) {
  Json json = Json::array();
  for (const ActionSpec& action : scenario.operator_.script) {
    const YamlNode* hand = action.parameters.Find("hand");
    json.push_back({{"action", action.action},
                    {"start", action.start},
                    {"duration", ActionTime(action)},
                    {"hand", hand ? hand->text : "both"},
                    {"text", Instruction(action, facing)}});
  }
  return json;
}

// Describes the place in which the page's camera and the headset's view begin, and the ground under
// the operator's feet.
Json DescribeViewpoint(const Scenario& scenario, const Viewpoint& viewpoint) {
  const auto& stance = scenario.operator_.stance;
  return {{"eye", ToJson(viewpoint.eye)},
          {"forward", {std::cos(viewpoint.facing), std::sin(viewpoint.facing), 0}},
          {"guess", viewpoint.is_a_guess},
          {"ground", stance ? ToJson(stance->ground) : Json(nullptr)},
          {"feet", stance.value_or(StanceSpec()).feet_apart}};
}

Json DescribeSurroundings(const Scenario& scenario, const Vector3& object_start) {
  const auto& table = scenario.environment.table;
  const SafetySpec& safety = scenario.safety;
  return {{"floor", scenario.environment.floor},
          {"table", table ? Json{{"size", ToJson(table->size)}, {"top", ToJson(table->top)}}
                          : Json(nullptr)},
          {"fixtures", DescribeFixtures(scenario, 0)},
          {"acting", DescribeActing(scenario, 0, 0)},
          {"guidance",
           {{"type", scenario.guidance.type},
            {"center", ToJson(object_start + scenario.guidance.center)},
            {"radius", scenario.guidance.radius}}},
          {"thresholds",
           {{"force", safety.force},
            {"torque", safety.torque},
            {"tracking", safety.tracking},
            {"security_distance", scenario.rendering.security_distance},
            {"influence_distance", scenario.rendering.influence_distance}}}};
}

// Returns the places of the existing handles in O [m].
std::array<Vector3, kHands> PlacesOfHandles(const Scenario& scenario) {
  std::array<Vector3, kHands> places = {Vector3::Zero(), Vector3::Zero()};
  for (const int h : scenario.hands())
    places[static_cast<std::size_t>(h)] = HandlePose(scenario, h).p;
  return places;
}

}  // namespace

nlohmann::ordered_json DescribeFixtures(const Scenario& scenario, std::uint16_t events) {
  Json json = Json::array();
  const std::vector<FixtureSpec>& fixtures = scenario.environment.fixtures;
  for (std::size_t i = 0; i < fixtures.size(); ++i) {
    const unsigned appears = EventsOfFixture(scenario, i);
    if (appears != 0 && (appears & events) == 0) continue;
    json.push_back({{"shape", NameOf(fixtures[i].shape)},
                    {"size", ToJson(fixtures[i].size)},
                    {"pose", ToJson(fixtures[i].X_WG())},
                    {"color", ToJson(fixtures[i].color)}});
    if (!fixtures[i].keep_out) continue;
    json.back()["keep_out"] = true;
    if (!fixtures[i].name.empty()) json.back()["name"] = fixtures[i].name;
  }
  return json;
}

nlohmann::ordered_json DescribeActing(const Scenario& scenario, std::uint16_t events,
                                      std::uint8_t latest_event) {
  const ParameterKinds kinds = Hazards();
  Json before = Json::array(), last = Json::array();
  for (std::size_t i = 0; i < scenario.events.size(); ++i) {
    if ((events >> i & 1U) == 0) continue;
    const std::string& event = scenario.events[i].event;
    const ParameterKind* kind = FindKind(kinds, event);
    const auto number = std::ranges::find(kinds, kind) - kinds.begin() + 1;
    (number == latest_event ? last : before).push_back(kind ? kind->doc : event);
  }
  before.insert(before.end(), last.begin(), last.end());
  return before;
}

nlohmann::ordered_json DescribeScene(const Scenario& scenario, const Vector3& object_start,
                                     AssetStore* assets) {
  Json json = {{"name", Printable(scenario.name)},
               {"file", scenario.file.stem().string()},
               {"mode", scenario.mode == Mode::kDirect ? "direct" : "emulate"},
               {"duration", scenario.duration},
               {"simulated", !RulesFor(scenario).external_device},
               {"operator", scenario.operator_.type},
               {"rate", scenario.rate}};
  json["cobot"] =
      DescribeRobot(scenario.cobot.model, scenario.cobot.remove_links, scenario.cobot.base.ToPose(),
                    scenario.cobot.end_effector, scenario.file.parent_path(), assets);
  json["object"] = DescribeBody(scenario.object.model, scenario.object.primitive, scenario, assets);
  json["handles"] = Json::object();
  json["arms"] = Json::object();
  for (int h = 0; h < kHands; ++h) {
    const char* side = HandName(h);
    json["handles"][side] = scenario.Has(h) ? ToJson(HandlePose(scenario, h)) : Json(nullptr);
    json["arms"][side] = DescribeArm(scenario, h, assets);
  }
  json.update(DescribeSurroundings(scenario, object_start));
  json["movables"] = DescribeMovables(scenario, assets);
  json["parameters"] = DescribeParameters(scenario);
  const Viewpoint viewpoint = ViewpointOf(scenario, object_start, PlacesOfHandles(scenario));
  json["viewpoint"] = DescribeViewpoint(scenario, viewpoint);
  json["script"] = DescribeScript(scenario, viewpoint.facing);
  return json;
}

}  // namespace predictor::viewer
