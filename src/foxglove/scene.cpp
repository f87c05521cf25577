// The topics /tf and /scene, which show poses and shapes.
#include <cmath>
#include <memory>
#include <numbers>

#include "foxglove/json.h"
#include "models/fixture_shapes.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/obstacle_events.h"

namespace predictor::foxglove {
namespace {

constexpr double kMetresPerNewton = 0.01;      // length of a force arrow
constexpr double kMetresPerNewtonMetre = 0.1;  // length of a torque arrow
constexpr double kHandleRadius = 0.02;         // [m]
constexpr double kHandleLength = 0.12;         // [m]
constexpr double kLinkRadius = 0.04;           // radius of the drawn cobot [m]
constexpr double kJointRadius = 0.055;         // [m]
constexpr int kCirclePoints = 72;

Json Xyzw(const Quaternion& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }

// Returns green below half of the limit, orange up to 80 % of the limit, and red above, as in the
// viewer.
Json WarningColor(double share) {
  if (share < 0.5) return Color(0.2, 0.7, 0.3, 1);
  if (share <= 0.8) return Color(0.95, 0.6, 0.1, 1);
  return Color(0.85, 0.15, 0.15, 1);
}

// The links of the virtual cobot, computed from its joint angles.
class Cobot {
 public:
  explicit Cobot(const Scenario& scenario)
      : model_(RobotModel::Load({scenario.cobot.model, scenario.file.parent_path(),
                                 scenario.cobot.remove_links, scenario.cobot.base.ToPose()})),
        data_(*model_),
        links_(model_->link_names()) {
    for (const std::string& link : links_) frames_.push_back(model_->Frame(link));
    const FrameId end_effector = model_->Frame(scenario.cobot.end_effector);
    // Only the joints that move the end-effector are drawn. The joints of a gripper are not drawn.
    Jacobian J(6, model_->dof());
    const JointVector zero = JointVector::Zero(model_->dof());
    data_.UpdateKinematics(*model_, zero, zero);
    data_.FrameJacobian(*model_, end_effector, &J);
    chain_.push_back({0, scenario.cobot.base.ToPose()});
    for (int j = 0; j < model_->dof(); ++j)
      if (J.col(j).norm() > 0) chain_.push_back({j + 1, {}});
    chain_.push_back(end_effector);
  }

  void Update(const TickRecord& r) {
    const int n = model_->dof();
    const JointVector q = Eigen::Map<const Eigen::VectorXd>(r.cobot_q.data(), n);
    data_.UpdateKinematics(*model_, q, JointVector::Zero(n));
  }
  const std::vector<std::string>& links() const { return links_; }
  Pose LinkPose(std::size_t link) const { return data_.FramePose(*model_, frames_[link]); }
  // Positions of the base, the joints and the end-effector in W, in this order [m].
  std::vector<Vector3> Points() const {
    std::vector<Vector3> points;
    points.reserve(chain_.size());
    for (const FrameId& frame : chain_) points.push_back(data_.FramePose(*model_, frame).p);
    return points;
  }

 private:
  std::shared_ptr<const RobotModel> model_;
  RobotData data_;
  std::vector<std::string> links_;
  std::vector<FrameId> frames_, chain_;
};

Json TransformJson(const std::string& child, const Pose& X, std::uint64_t ns) {
  return {{"timestamp", Time(ns)},
          {"parent_frame_id", "world"},
          {"child_frame_id", child},
          {"translation", Xyz(X.p)},
          {"rotation", Xyzw(X.q)}};
}

// Returns an empty entity. The message contains a list for each kind of primitive.
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
    case ShapeKind::kMesh:  // meshes are too large for a message sent 50 times per second
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
  entity["lines"].push_back({{"type", 1},  // closed line
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

struct DrawnFixture {
  std::vector<ModelShape> shapes;
  std::uint16_t events;  // events during which the entity is shown; 0: always shown
};

std::vector<DrawnFixture> FixturesOf(const Scenario& scenario) {
  std::vector<DrawnFixture> fixtures;
  for (std::size_t i = 0; i < scenario.environment.fixtures.size(); ++i)
    fixtures.push_back(
        {FixtureShapes(scenario.environment.fixtures[i]), EventsOfFixture(scenario, i)});
  return fixtures;
}

Json FixturesEntity(const std::vector<DrawnFixture>& fixtures, const TickRecord& r,
                    std::uint64_t ns) {
  Json entity = Entity("fixtures", "world", ns);
  for (const DrawnFixture& fixture : fixtures) {
    if (fixture.events != 0 && (fixture.events & r.events) == 0) continue;
    for (const ModelShape& shape : fixture.shapes) AddShape(shape, &entity);
  }
  return entity;
}

std::vector<ObjectModel> MovablesOf(const Scenario& scenario) {
  std::vector<ObjectModel> models;
  for (const MovableSpec& movable : scenario.environment.objects) {
    models.push_back(LoadObject({movable.model, movable.primitive, {}}, scenario.folder()));
    if (!movable.model.empty()) continue;
    const Vector3& c = movable.color;
    for (ModelShape& shape : models.back().visuals) shape.color = {c.x(), c.y(), c.z(), 1};
  }
  return models;
}

Json MovablesEntity(const std::vector<ObjectModel>& models, const TickRecord& r, std::uint64_t ns) {
  Json entity = Entity("movables", "world", ns);
  for (std::size_t i = 0; i < std::min<std::size_t>(models.size(), r.movable_count); ++i)
    for (ModelShape shape : models[i].visuals) {
      shape.X_LG = FromRecord(r.movables[i]) * shape.X_LG;
      AddShape(shape, &entity);
    }
  return entity;
}

// The joints and the segments between them. Meshes are too large for a message sent 50 times per
// second.
Json CobotEntity(const std::vector<Vector3>& points, std::uint64_t ns) {
  Json entity = Entity("cobot", "world", ns);
  ModelShape shape;
  shape.color = {0.85, 0.85, 0.88, 1};
  for (std::size_t k = 0; k < points.size(); ++k) {
    shape.kind = ShapeKind::kSphere;
    shape.size = {kJointRadius, 0, 0};
    shape.X_LG = {points[k], Quaternion::Identity()};
    AddShape(shape, &entity);
    const Vector3 along = k > 0 ? Vector3(points[k] - points[k - 1]) : Vector3::Zero();
    if (!(along.norm() > 1e-3)) continue;
    shape.kind = ShapeKind::kCylinder;
    shape.size = {kLinkRadius, along.norm(), 0};
    shape.X_LG = {points[k] - along / 2, Quaternion::FromTwoVectors(Vector3::UnitZ(), along)};
    AddShape(shape, &entity);
  }
  return entity;
}

}  // namespace

FoxgloveChannel TransformsChannel(const Scenario& scenario) {
  const auto cobot = std::make_shared<Cobot>(scenario);
  return {"/tf", "foxglove.FrameTransforms", FrameTransformsSchema(),
          [cobot](const TickRecord& r, std::uint64_t ns) {
            Json list = Json::array();
            list.push_back(TransformJson("object", FromRecord(r.object.pose), ns));
            list.push_back(TransformJson("end_effector", FromRecord(r.end_effector.pose), ns));
            for (std::size_t h = 0; h < kHands; ++h) {
              if (!r.hands[h].present) continue;
              const std::string side = kHandNames[h];
              list.push_back(TransformJson(side + "_real", FromRecord(r.hands[h].real.pose), ns));
              list.push_back(
                  TransformJson(side + "_virtual", FromRecord(r.hands[h].virtual_.pose), ns));
            }
            cobot->Update(r);
            for (std::size_t k = 0; k < cobot->links().size(); ++k)
              list.push_back(TransformJson("cobot/" + cobot->links()[k], cobot->LinkPose(k), ns));
            return Json{{"transforms", list}};
          }};
}

FoxgloveChannel SceneChannel(const Scenario& scenario, const Vector3& object_start) {
  const auto cobot = std::make_shared<Cobot>(scenario);
  const ObjectModel object = LoadObject(scenario.object, scenario.file.parent_path());
  const bool circle = scenario.guidance.type == "circle";
  const Vector3 center = object_start + scenario.guidance.center;
  const double radius = scenario.guidance.radius;
  const bool floor = scenario.environment.floor;
  const std::vector<DrawnFixture> fixtures = FixturesOf(scenario);
  const std::vector<ObjectModel> movables = MovablesOf(scenario);
  return {"/scene", "foxglove.SceneUpdate", SceneUpdateSchema(),
          [cobot, object, circle, center, radius, floor, fixtures, movables](const TickRecord& r,
                                                                             std::uint64_t ns) {
            Json entities = Json::array();
            if (floor) entities.push_back(FloorEntity(ns));
            if (!fixtures.empty()) entities.push_back(FixturesEntity(fixtures, r, ns));
            if (!movables.empty()) entities.push_back(MovablesEntity(movables, r, ns));
            if (circle) entities.push_back(GuidanceEntity(center, radius, ns));
            cobot->Update(r);
            entities.push_back(CobotEntity(cobot->Points(), ns));
            Json box = Entity("object", "object", ns);
            for (const ModelShape& shape : object.visuals) AddShape(shape, &box);
            entities.push_back(box);
            for (std::size_t h = 0; h < kHands; ++h)
              if (r.hands[h].present) entities.push_back(HandEntity(h, r, ns));
            return Json{{"deletions", Json::array()}, {"entities", entities}};
          }};
}

}  // namespace predictor::foxglove
