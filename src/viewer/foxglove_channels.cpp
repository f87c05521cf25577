// What each topic says, in Foxglove's well-known schemas where there is one.
#include <cmath>
#include <numbers>

#include "core/status.h"
#include "models/robot.h"
#include "scenario/paths.h"
#include "viewer/foxglove.h"

namespace predictor {
namespace {

constexpr double kMetresPerNewton = 0.01;      // length of a force's arrow
constexpr double kMetresPerNewtonMetre = 0.1;  // of a torque's
constexpr double kHandleRadius = 0.02;         // [m]
constexpr double kHandleLength = 0.12;         // [m]
constexpr int kCirclePoints = 72;

// ---- values
// --------------------------------------------------------------------------------------

Json Time(std::uint64_t ns) { return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}}; }

Json Xyz(const Vector3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

Json Xyz(const double* v) { return Xyz(Vector3(v[0], v[1], v[2])); }

Json Xyzw(const Quaternion& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }

Json PoseJson(const Pose& X) { return {{"position", Xyz(X.p)}, {"orientation", Xyzw(X.q)}}; }

Json Color(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

// Green below half of the limit, orange to 80 %, then red: as on the page.
Json WarningColor(double share) {
  if (share < 0.5) return Color(0.2, 0.7, 0.3, 1);
  if (share < 0.8) return Color(0.95, 0.6, 0.1, 1);
  return Color(0.85, 0.15, 0.15, 1);
}

// ---- schemas
// -------------------------------------------------------------------------------------

Json Number() { return {{"type", "number"}}; }
Json Text() { return {{"type", "string"}}; }
Json ListOf(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json Object(const Json& properties) { return {{"type", "object"}, {"properties", properties}}; }

Json Numbers(std::initializer_list<const char*> names) {
  Json properties = Json::object();
  for (const char* name : names) properties[name] = Number();
  return Object(properties);
}

Json TimeSchema() {
  return Object({{"sec", {{"type", "integer"}}}, {"nsec", {{"type", "integer"}}}});
}
Json XyzSchema() { return Numbers({"x", "y", "z"}); }
Json XyzwSchema() { return Numbers({"x", "y", "z", "w"}); }
Json PoseSchema() { return Object({{"position", XyzSchema()}, {"orientation", XyzwSchema()}}); }
Json ColorSchema() { return Numbers({"r", "g", "b", "a"}); }

Json Titled(const char* title, Json schema) {
  schema["title"] = title;
  return schema;
}

// ---- /tf
// -----------------------------------------------------------------------------------------

Json TransformJson(const char* parent, const std::string& child, const PoseRecord& X,
                   std::uint64_t ns) {
  const Pose pose = FromRecord(X);
  return {{"timestamp", Time(ns)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", Xyz(pose.p)},
          {"rotation", Xyzw(pose.q)}};
}

FoxgloveChannel Transforms() {
  const Json transform = Object({{"timestamp", TimeSchema()},
                                 {"parent_frame_id", Text()},
                                 {"child_frame_id", Text()},
                                 {"translation", XyzSchema()},
                                 {"rotation", XyzwSchema()}});
  return {
      "/tf", "foxglove.FrameTransforms",
      Titled("foxglove.FrameTransforms", Object({{"transforms", ListOf(transform)}})),
      [](const TickRecord& r, std::uint64_t ns) {
        Json list = Json::array();
        list.push_back(TransformJson("world", "object", r.object.pose, ns));
        list.push_back(TransformJson("world", "end_effector", r.end_effector.pose, ns));
        for (std::size_t h = 0; h < kHands; ++h) {
          if (!r.hands[h].present) continue;
          const std::string side = kHandNames[h];
          list.push_back(TransformJson("world", side + "_real", r.hands[h].real.pose, ns));
          list.push_back(TransformJson("world", side + "_virtual", r.hands[h].virtual_.pose, ns));
        }
        return Json{{"transforms", list}};
      }};
}

// ---- /scene
// --------------------------------------------------------------------------------------

// An entity without anything in it; each kind of primitive is a list.
Json Entity(const std::string& id, const std::string& frame, std::uint64_t ns) {
  Json entity = {{"timestamp", Time(ns)}, {"frame_id", frame},    {"id", id},
                 {"lifetime", Time(0)},   {"frame_locked", true}, {"metadata", Json::array()}};
  for (const char* kind :
       {"arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
    entity[kind] = Json::array();
  return entity;
}

void AddShape(const ModelShape& shape, Json* entity) {
  const auto& c = shape.color;
  const Json color = Color(c[0], c[1], c[2], c[3]);
  const Json pose = PoseJson(shape.X_LG);
  const double diameter = 2 * shape.size.x();
  switch (shape.kind) {
    case ShapeKind::kBox:
      (*entity)["cubes"].push_back({{"pose", pose}, {"size", Xyz(shape.size)}, {"color", color}});
      break;
    case ShapeKind::kCylinder:
      (*entity)["cylinders"].push_back({{"pose", pose},
                                        {"size", Xyz(Vector3(diameter, diameter, shape.size.y()))},
                                        {"bottom_scale", 1.0},
                                        {"top_scale", 1.0},
                                        {"color", color}});
      break;
    case ShapeKind::kSphere:
      (*entity)["spheres"].push_back(
          {{"pose", pose}, {"size", Xyz(Vector3(diameter, diameter, diameter))}, {"color", color}});
      break;
    case ShapeKind::kMesh:  // a mesh has no place in a message fifty times a second
      break;
  }
}

void AddArrow(const Vector3& from, const Vector3& along, double metres, double width,
              const Json& color, Json* entity) {
  const double length = along.norm() * metres;
  if (!(length > 1e-3)) return;
  const Quaternion q = Quaternion::FromTwoVectors(Vector3::UnitX(), along);
  (*entity)["arrows"].push_back({{"pose", PoseJson({from, q})},
                                 {"shaft_length", 0.75 * length},
                                 {"shaft_diameter", width},
                                 {"head_length", 0.25 * length},
                                 {"head_diameter", 2 * width},
                                 {"color", color}});
}

Json HandEntity(std::size_t h, const TickRecord& r, std::uint64_t ns) {
  const HandRecord& hand = r.hands[h];
  const std::string side = kHandNames[h];
  Json entity = Entity(side + "_hand", "world", ns);
  ModelShape handle;
  handle.kind = ShapeKind::kCylinder;
  handle.size = {kHandleRadius, kHandleLength, 0};
  handle.X_LG = FromRecord(hand.virtual_.pose);
  handle.color = {0.25, 0.45, 0.85, 1};
  AddShape(handle, &entity);
  handle.X_LG = FromRecord(hand.real.pose);
  handle.color = {0.5, 0.5, 0.5, 0.5};
  AddShape(handle, &entity);
  const Vector3 force(hand.wrench[0], hand.wrench[1], hand.wrench[2]);
  const Vector3 torque(hand.wrench[3], hand.wrench[4], hand.wrench[5]);
  const Vector3 from = FromRecord(hand.virtual_.pose).p;
  const auto limit = [&r](Parameter p) { return r.parameters[static_cast<std::size_t>(p)]; };
  AddArrow(from, force, kMetresPerNewton, 0.012,
           WarningColor(force.norm() / limit(Parameter::kForceThreshold)), &entity);
  AddArrow(from, torque, kMetresPerNewtonMetre, 0.008,
           WarningColor(torque.norm() / limit(Parameter::kTorqueThreshold)), &entity);
  return entity;
}

Json GuidanceEntity(const Vector3& center, double radius, std::uint64_t ns) {
  Json points = Json::array();
  for (int i = 0; i < kCirclePoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCirclePoints;
    points.push_back(Xyz(center + radius * Vector3(std::cos(angle), std::sin(angle), 0)));
  }
  Json entity = Entity("guidance", "world", ns);
  entity["lines"].push_back({{"type", 1},  // closed
                             {"pose", PoseJson({})},
                             {"thickness", 0.005},
                             {"scale_invariant", false},
                             {"points", points},
                             {"color", Color(0.2, 0.5, 0.9, 1)},
                             {"colors", Json::array()},
                             {"indices", Json::array()}});
  return entity;
}

Json FloorEntity(std::uint64_t ns) {
  Json entity = Entity("floor", "world", ns);
  ModelShape floor;
  floor.kind = ShapeKind::kBox;
  floor.size = {4, 4, 0.002};
  floor.X_LG.p.z() = -0.002;
  floor.color = {0.6, 0.6, 0.6, 0.5};
  AddShape(floor, &entity);
  return entity;
}

Json SceneSchema() {
  const Json solid =
      Object({{"pose", PoseSchema()}, {"size", XyzSchema()}, {"color", ColorSchema()}});
  const Json cylinder = Object({{"pose", PoseSchema()},
                                {"size", XyzSchema()},
                                {"bottom_scale", Number()},
                                {"top_scale", Number()},
                                {"color", ColorSchema()}});
  const Json arrow = Object({{"pose", PoseSchema()},
                             {"shaft_length", Number()},
                             {"shaft_diameter", Number()},
                             {"head_length", Number()},
                             {"head_diameter", Number()},
                             {"color", ColorSchema()}});
  const Json line = Object({{"type", {{"type", "integer"}}},
                            {"pose", PoseSchema()},
                            {"thickness", Number()},
                            {"scale_invariant", {{"type", "boolean"}}},
                            {"points", ListOf(XyzSchema())},
                            {"color", ColorSchema()},
                            {"colors", ListOf(ColorSchema())},
                            {"indices", ListOf({{"type", "integer"}})}});
  const Json any = ListOf({{"type", "object"}});
  const Json entity = Object({{"timestamp", TimeSchema()},
                              {"frame_id", Text()},
                              {"id", Text()},
                              {"lifetime", TimeSchema()},
                              {"frame_locked", {{"type", "boolean"}}},
                              {"metadata", any},
                              {"arrows", ListOf(arrow)},
                              {"cubes", ListOf(solid)},
                              {"spheres", ListOf(solid)},
                              {"cylinders", ListOf(cylinder)},
                              {"lines", ListOf(line)},
                              {"triangles", any},
                              {"texts", any},
                              {"models", any}});
  return Titled("foxglove.SceneUpdate", Object({{"deletions", any}, {"entities", ListOf(entity)}}));
}

FoxgloveChannel SceneUpdates(const Scenario& scenario, const Vector3& object_start) {
  const ObjectModel object = LoadObject(scenario.object, scenario.file.parent_path());
  const bool circle = scenario.guidance.type == "circle";
  const Vector3 center = object_start + scenario.guidance.center;
  const double radius = scenario.guidance.radius;
  const bool floor = scenario.environment.floor;
  return {"/scene", "foxglove.SceneUpdate", SceneSchema(),
          [object, circle, center, radius, floor](const TickRecord& r, std::uint64_t ns) {
            Json entities = Json::array();
            if (floor) entities.push_back(FloorEntity(ns));
            if (circle) entities.push_back(GuidanceEntity(center, radius, ns));
            Json box = Entity("object", "object", ns);
            for (const ModelShape& shape : object.visuals) AddShape(shape, &box);
            entities.push_back(box);
            for (std::size_t h = 0; h < kHands; ++h)
              if (r.hands[h].present) entities.push_back(HandEntity(h, r, ns));
            return Json{{"deletions", Json::array()}, {"entities", entities}};
          }};
}

// ---- plain values
// --------------------------------------------------------------------------------

FoxgloveChannel JointStates(const Scenario& scenario) {
  const RobotSource source{scenario.cobot.model, scenario.file.parent_path(),
                           scenario.cobot.remove_links, scenario.cobot.base.ToPose()};
  const auto robot = RobotModel::Load(source);
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(robot->dof()));
  for (int j = 0; j < robot->dof(); ++j) names.push_back(robot->joint_name(j));
  const Json joint = Object(
      {{"name", Text()}, {"position", Number()}, {"velocity", Number()}, {"effort", Number()}});
  return {"/joint_states", "foxglove.JointStates",
          Titled("foxglove.JointStates",
                 Object({{"timestamp", TimeSchema()}, {"joints", ListOf(joint)}})),
          [names](const TickRecord& r, std::uint64_t ns) {
            Json joints = Json::array();
            for (std::size_t j = 0; j < names.size(); ++j)
              joints.push_back({{"name", names[j]},
                                {"position", r.cobot_q[j]},
                                {"velocity", r.cobot_v[j]},
                                {"effort", r.cobot_torque[j]}});
            return Json{{"timestamp", Time(ns)}, {"joints", joints}};
          }};
}

FoxgloveChannel RunStates() {
  Json stages = Json::object();
  for (const char* stage : kStageNames) stages[stage] = Number();
  return {"/run", "predictor.Run",
          Titled("predictor.Run", Object({{"timestamp", TimeSchema()},
                                          {"state", Text()},
                                          {"cause", Text()},
                                          {"cause_value", Number()},
                                          {"cause_limit", Number()},
                                          {"tick", {{"type", "integer"}}},
                                          {"run_time", Number()},
                                          {"action", {{"type", "integer"}}},
                                          {"stage_us", Object(stages)}})),
          [](const TickRecord& r, std::uint64_t ns) {
            Json times = Json::object();
            for (std::size_t s = 0; s < kStages; ++s) times[kStageNames[s]] = r.stage_us[s];
            return Json{{"timestamp", Time(ns)},
                        {"state", Name(r.state)},
                        {"cause", Name(r.cause)},
                        {"cause_value", r.cause_value},
                        {"cause_limit", r.cause_limit},
                        {"tick", r.tick},
                        {"run_time", r.run_time},
                        {"action", r.action},
                        {"stage_us", times}};
          }};
}

FoxgloveChannel WrenchOf(std::size_t h) {
  return {std::string("/wrench_") + kHandNames[h], "predictor.Wrench",
          Titled("predictor.Wrench", Object({{"timestamp", TimeSchema()},
                                             {"frame_id", Text()},
                                             {"force", XyzSchema()},
                                             {"torque", XyzSchema()},
                                             {"force_norm", Number()},
                                             {"torque_norm", Number()}})),
          [h](const TickRecord& r, std::uint64_t ns) {
            const double* w = r.hands[h].wrench.data();
            return Json{{"timestamp", Time(ns)},
                        {"frame_id", "world"},
                        {"force", Xyz(w)},
                        {"torque", Xyz(w + 3)},
                        {"force_norm", std::hypot(w[0], w[1], w[2])},
                        {"torque_norm", std::hypot(w[3], w[4], w[5])}};
          }};
}

FoxgloveChannel Tracking() {
  const Json hand = Numbers({"translation_m", "rotation_rad"});
  return {"/tracking", "predictor.Tracking",
          Titled("predictor.Tracking", Object({{"timestamp", TimeSchema()},
                                               {"left", hand},
                                               {"right", hand},
                                               {"elbow_distance_m", Number()}})),
          [](const TickRecord& r, std::uint64_t ns) {
            Json message = {{"timestamp", Time(ns)}};
            for (std::size_t h = 0; h < kHands; ++h) {
              if (!r.hands[h].present) continue;
              const Vector6 error =
                  PoseError(FromRecord(r.hands[h].virtual_.pose), FromRecord(r.hands[h].real.pose));
              message[kHandNames[h]] = {{"translation_m", error.head<3>().norm()},
                                        {"rotation_rad", error.tail<3>().norm()}};
            }
            message["elbow_distance_m"] = r.elbow_distance;
            return message;
          }};
}

}  // namespace

std::vector<FoxgloveChannel> FoxgloveChannels(const Scenario& scenario,
                                              const Vector3& object_start) {
  return {Transforms(),
          SceneUpdates(scenario, object_start),
          JointStates(scenario),
          RunStates(),
          WrenchOf(0),
          WrenchOf(1),
          Tracking()};
}

}  // namespace predictor
