#include "simulation/dart/dart_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "core/text.h"
#include "models/robot_impl.h"
#include "simulation/touches.h"

namespace predictor {
namespace {

using dart_engine::SceneData;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kBallRadius = 0.04;  // that defines a hand's inertia [m]

static_assert(dart_engine::kMaxJoints == kMaxCobotJoints);
static_assert(dart_engine::kHandCount == kHands);

void CopyVector(const Vector3& from, double* to) { std::copy_n(from.data(), 3, to); }

dart_engine::FramePose PoseFor(const Pose& X) {
  dart_engine::FramePose to{};
  CopyVector(X.p, to.p);
  to.q[0] = X.q.w(), to.q[1] = X.q.x(), to.q[2] = X.q.y(), to.q[3] = X.q.z();
  return to;
}

dart_engine::Inertia InertiaFor(double mass, const Vector3& com, const Matrix3& inertia) {
  dart_engine::Inertia to{};
  to.mass = mass;
  CopyVector(com, to.com);
  std::copy_n(inertia.data(), 9, to.inertia);
  return to;
}

// Converts from the inertia about the joint's origin.
dart_engine::Inertia InertiaFor(const BodyInertia& body) {
  if (body.mass <= 0) return InertiaFor(0, Vector3::Zero(), Matrix3::Zero());
  const Vector3 com = body.moment / body.mass;
  const Matrix3 about_com = body.inertia + body.mass * Skew(com) * Skew(com);
  return InertiaFor(body.mass, com, about_com);
}

void AddJoints(const Scenario& scenario, const RobotModel& cobot, SceneData* scene) {
  const EngineModel& model = cobot.impl().engine;
  const bool is_limited = scenario.simulation.joint_limits != JointLimits::kNone;
  const bool is_slow = scenario.simulation.velocity_limits == VelocityLimits::kHard;
  scene->joints = cobot.dof();
  for (int j = 0; j < cobot.dof(); ++j) {
    const EngineJoint& from = model.joints[static_cast<std::size_t>(j)];
    dart_engine::CobotJoint& to = scene->joint[j];
    to.parent = static_cast<std::int32_t>(from.parent) - 1;
    to.prismatic = from.prismatic ? 1 : 0;
    to.at = PoseFor({from.p_PJ, Quaternion(from.R_PJ)});
    CopyVector(from.axis, to.axis);
    to.body = InertiaFor(from.body);
    to.damping = OneOrEach(scenario.cobot.joint_friction.viscous, j);
    to.lower = is_limited ? cobot.position_lower()[j] : -kUnlimited;
    to.upper = is_limited ? cobot.position_upper()[j] : kUnlimited;
    to.speed = is_slow ? cobot.velocity_limit()[j] : kUnlimited;
  }
}

void AddAttachment(const Scenario& scenario, const ObjectModel& object, Holding holding,
                   SceneData* scene) {
  const AttachmentSpec& spec = scenario.object.attachment;
  using Kind = dart_engine::Attachment;
  scene->object = InertiaFor(object.mass, object.com, object.inertia);
  scene->has_hand_masses = scenario.mode == Mode::kDirect ? 1 : 0;
  scene->hand_radius = kBallRadius;
  for (int hand = 0; hand < kHands; ++hand)
    if (scenario.Has(hand)) CopyVector(HandlePose(scenario, hand).p, scene->handle[hand]);
  scene->lower = -kUnlimited, scene->upper = kUnlimited;
  CopyVector(Vector3::UnitZ(), scene->axis);
  if (holding == Holding::kFree) {
    scene->attachment = Kind::kFree;
    scene->object_at = PoseFor(Pose::Identity());
    return;
  }
  scene->attachment = spec.joint == JointType::kFixed       ? Kind::kWeld
                      : spec.joint == JointType::kSpherical ? Kind::kBall
                      : spec.joint == JointType::kRevolute  ? Kind::kRevolute
                                                            : Kind::kPrismatic;
  const Pose X_OA = spec.on_object.ToPose();
  scene->object_at = PoseFor(spec.on_end_effector.ToPose() * X_OA.Inverse());
  CopyVector(X_OA.p, scene->pivot);
  if (spec.joint == JointType::kRevolute || spec.joint == JointType::kPrismatic)
    CopyVector((X_OA.q * spec.axis).normalized(), scene->axis);
  scene->damping = spec.damping;
  if (!spec.range || scenario.simulation.joint_limits == JointLimits::kNone) return;
  scene->lower = (*spec.range)[0], scene->upper = (*spec.range)[1];
}

// Refuses properties that a rigid contact cannot have, and contacts of the cobot, because its links
// are meshes.
void CheckFixture(const FixtureSpec& fixture, std::size_t i) {
  const std::string path = "environment.fixtures." + std::to_string(i);
  const auto refuse = [&path](const std::string& key, const std::string& why,
                              const std::string& remedy) {
    throw InputError::At(path + key, path + key + " " + why + ", but simulation.engine is dart, " +
                                         remedy + ", or set simulation.engine: mujoco.");
  };
  if (fixture.stiffness)
    refuse(".stiffness", "is given", "whose contacts are rigid. Remove stiffness and damping");
  if (fixture.time_constant != FixtureSpec{}.time_constant)
    refuse(".time_constant", "is given", "whose contacts are rigid. Remove time_constant");
  if (fixture.keep_out)
    refuse(".keep_out", "is true", "in which the cobot touches no fixtures. Remove the fixture");
  if (fixture.Touches("cobot"))
    refuse(".touches", "contains cobot",
           "in which only the object touches fixtures. Remove cobot from touches");
}

using ObstacleKind = dart_engine::ShapeKind;

void AddObstacle(ObstacleKind kind, const Vector3& size, const Pose& at, double friction,
                 SceneData* scene) {
  dart_engine::Obstacle& obstacle = scene->obstacle[scene->obstacles++];
  obstacle.shape.kind = kind;
  CopyVector(size, obstacle.shape.size);
  obstacle.shape.at = PoseFor(at);
  obstacle.friction = friction;
  obstacle.fixture = -1;
}

void AddSurroundings(const EnvironmentSpec& environment, SceneData* scene) {
  constexpr ObstacleKind kKinds[] = {ObstacleKind::kBox, ObstacleKind::kCylinder,
                                     ObstacleKind::kCapsule, ObstacleKind::kSphere,
                                     ObstacleKind::kPlane};  // by FixtureShape
  scene->gravity = environment.gravity;
  if (environment.floor)
    AddObstacle(ObstacleKind::kPlane, Vector3::Zero(), Pose::Identity(), environment.friction,
                scene);
  if (environment.table) {
    const TableSpec& table = *environment.table;
    AddObstacle(ObstacleKind::kBox, table.size,
                {table.top - Vector3(0, 0, table.size.z() / 2), Quaternion::Identity()},
                environment.friction, scene);
  }
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i) {
    const FixtureSpec& fixture = environment.fixtures[i];
    CheckFixture(fixture, i);
    if (!fixture.Touches("object")) continue;
    AddObstacle(kKinds[static_cast<std::size_t>(fixture.shape)], fixture.size, fixture.X_WG(),
                fixture.friction.value_or(environment.friction), scene);
    dart_engine::Obstacle& obstacle = scene->obstacle[scene->obstacles - 1];
    obstacle.restitution = RestitutionOf(fixture.damping_ratio);
    obstacle.fixture = static_cast<std::int32_t>(i);
  }
}

void AddShapes(const ObjectModel& object, SceneData* scene) {
  if (scene->obstacles == 0) return;
  using Kind = dart_engine::ShapeKind;
  for (const ModelShape& shape : object.collisions) {
    if (shape.kind == ShapeKind::kMesh || scene->shapes == dart_engine::kMaxShapes)
      throw InputError::At(
          "object.model",
          "object.model: " + shape.place +
              ": simulation.engine is dart, which lets only boxes, cylinders and spheres collide, "
              "at most " +
              std::to_string(dart_engine::kMaxShapes) +
              ". Describe <collision> by them, remove floor, table and fixtures from environment, "
              "or set simulation.engine: mujoco.");
    dart_engine::CollisionShape& to = scene->shape[scene->shapes++];
    to.kind = shape.kind == ShapeKind::kBox        ? Kind::kBox
              : shape.kind == ShapeKind::kCylinder ? Kind::kCylinder
                                                   : Kind::kSphere;
    CopyVector(shape.size, to.size);
    to.at = PoseFor(shape.X_LG);
  }
}

}  // namespace

SceneData DartScene(const Scenario& scenario, const RobotModel& cobot, const ObjectModel& object,
                    double step, Holding holding) {
  if (scenario.simulation.joint_limits == JointLimits::kSoft)
    throw InputError::At("simulation.joint_limits",
                         "simulation.joint_limits is soft, but simulation.engine is dart, whose "
                         "limits are hard. Set it to hard or none, or set simulation.engine: "
                         "mujoco.");
  if (!scenario.cobot.touches.empty())
    throw InputError::At("cobot.touches",
                         "cobot.touches is given, but simulation.engine is dart, in which the "
                         "cobot's links collide with nothing. Remove cobot.touches, or set "
                         "simulation.engine: mujoco.");
  SceneData scene{};
  scene.step = step;
  AddJoints(scenario, cobot, &scene);
  const FrameId E = cobot.Frame(scenario.cobot.end_effector);
  scene.carrier = E.body - 1;
  scene.end_effector = PoseFor(E.X_JF);
  AddAttachment(scenario, object, holding, &scene);
  AddSurroundings(scenario.environment, &scene);
  RequireShapes(scenario, Toucher::kObject, object.collisions.size());
  AddShapes(object, &scene);
  return scene;
}

double RestitutionOf(double damping_ratio) {
  const double zeta = damping_ratio;
  const double root = std::sqrt(std::fabs(1 - zeta * zeta));
  constexpr double kCritical = 1e-6;  // below this, both formulas have their common limit
  if (root < kCritical) return std::exp(-2);
  if (zeta > 1) return std::exp(-zeta / root * std::log((zeta + root) / (zeta - root)));
  return std::exp(-zeta / root * (M_PI - std::atan2(2 * zeta * root, root * root - zeta * zeta)));
}

}  // namespace predictor
