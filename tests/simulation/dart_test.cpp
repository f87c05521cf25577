// Compares the engine DART with MuJoCo, which computes the same physics in another way.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "models/object_model.h"
#include "scenario/scenario_io.h"
#include "simulation/dart/dart_process.h"
#include "simulation/dart/dart_scene.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

constexpr double kDuration = 5;  // [s]
constexpr double kMaxDifference =
    1e-8;  // [m], as the engines' rounding errors grow in a closed loop

// Removes joint limits and Coulomb friction, because the two engines treat them differently.
Scenario Comparable(Scenario s) {
  s.cobot.joint_friction.coulomb = {0};
  s.simulation.joint_limits = JointLimits::kNone;
  return s;
}

Scenario With(EngineKind engine, Scenario s) {
  s.simulation.engine = engine;
  return s;
}

// Returns the input of hands that pull the handles along a smooth path with springs and dampers.
WorldInput DrawHandles(const Scenario& s, const WorldState& start, const WorldState& now) {
  constexpr double kStiffness = 150, kDamping = 30, kTurnStiffness = 2, kTurnDamping = 0.2;
  const double x = std::sin(0.5 * now.time);
  const Vector3 path = Vector3(0.05, 0.15, 0.08) * (x * x);
  WorldInput input = HandsOff(s);
  for (const int h : s.hands()) {
    const FrameMotion& D = now.handle[h];
    const Vector3 wanted = start.handle[h].X_W.p + path;
    input.F_H_W[h].head<3>() =
        kStiffness * (wanted - D.X_W.p) - kDamping * Vector3(D.V_W.head<3>());
    input.F_H_W[h].tail<3>() = kTurnStiffness * RotationError(start.handle[h].X_W.q, D.X_W.q) -
                               kTurnDamping * Vector3(D.V_W.tail<3>());
    input.hand_mass[static_cast<std::size_t>(h)] = s.mode == Mode::kDirect ? 1.5 : 0;
  }
  return input;
}

struct Moved {
  double difference = 0;  // of the object's place [m]
  double angle = 0;       // of its attitude [rad]
  double distance = 0;    // that the object moved [m]
};

// Guides the object in both engines. The hands in each engine react to the motion in this engine.
Moved Compare(const Scenario& scenario) {
  const Scenario s = Comparable(scenario);
  World mujoco(With(EngineKind::kMujoco, s)), dart(With(EngineKind::kDart, s));
  const WorldState first = mujoco.state(), second = dart.state();
  Moved moved;
  for (int i = 0; i < static_cast<int>(kDuration / kTick); ++i) {
    EXPECT_TRUE(mujoco.Step(DrawHandles(s, first, mujoco.state()), kTick).ok());
    EXPECT_TRUE(dart.Step(DrawHandles(s, second, dart.state()), kTick).ok())
        << dart.EngineFailure();
    if (testing::Test::HasFailure()) return moved;
    const Pose& a = mujoco.state().object.X_W;
    const Pose& b = dart.state().object.X_W;
    moved.difference = std::max(moved.difference, (a.p - b.p).norm());
    moved.angle = std::max(moved.angle, RotationError(a.q, b.q).norm());
    moved.distance = std::max(moved.distance, (a.p - first.object.X_W.p).norm());
  }
  return moved;
}

void ExpectAlike(const Scenario& scenario) {
  const Moved moved = Compare(scenario);
  EXPECT_LE(moved.difference, kMaxDifference);
  EXPECT_GT(moved.distance, 0.02);
  std::printf("%.2g m, %.2g rad, over %.2f m\n", moved.difference, moved.angle, moved.distance);
}

// The fixture of tests with DART. A build without DART skips these tests.
class Dart : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasDart()) GTEST_SKIP() << "This build has no DART.";
  }
};

// ---- the same motion ---------------------------------------------------------------------------

class DartAttachment : public Dart, public testing::WithParamInterface<JointType> {};

TEST_P(DartAttachment, MovesAsInMujoco) {
  Scenario s = BoxScene(9);
  s.object.attachment.joint = GetParam();
  s.object.attachment.axis = {0.2, 0.1, 1};
  s.object.attachment.damping = GetParam() == JointType::kPrismatic ? 200 : 0.5;
  if (GetParam() == JointType::kPrismatic) s.environment.gravity = 0;  // it would slide off
  ExpectAlike(s);
}

std::string NameOfJoint(const testing::TestParamInfo<JointType>& joint) {
  constexpr std::array<const char*, 4> kNames = {"Spherical", "Fixed", "Revolute", "Prismatic"};
  return kNames[static_cast<std::size_t>(joint.param)];
}

INSTANTIATE_TEST_SUITE_P(Joints, DartAttachment,
                         testing::Values(JointType::kSpherical, JointType::kFixed,
                                         JointType::kRevolute, JointType::kPrismatic),
                         NameOfJoint);

TEST_F(Dart, MovesHandsWithMassAsInMujoco) {
  Scenario s = BoxScene(9);
  s.mode = Mode::kDirect;
  ExpectAlike(s);
}

// Tests the shipped scenarios without their events. The test omits `underdamped`, which is unstable
// on purpose, and the scenarios in which the object touches something or pushes movable objects.
class DartScenario : public Dart, public testing::WithParamInterface<const char*> {};

TEST_P(DartScenario, MovesAsInMujoco) {
  const std::string folder = std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/";
  Scenario s = LoadScenario(folder + GetParam() + ".yaml");
  s.events.clear();
  ExpectAlike(s);
}

std::string NameOfScenario(const testing::TestParamInfo<const char*>& scenario) {
  return scenario.param;
}

INSTANTIATE_TEST_SUITE_P(Scenarios, DartScenario,
                         testing::Values("admittance", "bar_circle", "box_18kg", "box_9kg",
                                         "by_hand", "circle_by_hand", "dual_ur5", "excite_cobot",
                                         "hand_over_tool", "identify_arm", "linear_axis",
                                         "minimum_jerk_intention", "mobile_base", "push",
                                         "single_arm", "ur_and_panda", "variable_impedance",
                                         "virtual_fixtures"),
                         NameOfScenario);

// ---- states ------------------------------------------------------------------------------------

TEST_F(Dart, ContinuesARestoredStateBitForBit) {
  const Scenario s = With(EngineKind::kDart, BoxScene(9));
  World world(s);
  const WorldState start = world.state();
  for (int i = 0; i < 200; ++i)
    ASSERT_TRUE(world.Step(DrawHandles(s, start, world.state()), kTick).ok());
  std::vector<std::byte> bytes(1 << 16);
  StateArchive save = StateArchive::ToSave(bytes);
  world.Archive(save);
  ASSERT_TRUE(save.ok());
  const auto go_on = [&](World* from) {
    std::vector<WorldState> states;
    for (int i = 0; i < 200; ++i) {
      EXPECT_TRUE(from->Step(DrawHandles(s, start, from->state()), kTick).ok());
      states.push_back(from->state());
    }
    return states;
  };
  const std::vector<WorldState> first = go_on(&world);
  World other(s);
  StateArchive load = StateArchive::ToLoad(std::span(bytes).first(save.used()));
  other.Archive(load);
  ASSERT_TRUE(load.ok());
  const std::vector<WorldState> second = go_on(&other);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].q, second[i].q) << i;
    ASSERT_EQ(first[i].object.X_W.p, second[i].object.X_W.p) << i;
    ASSERT_EQ(first[i].object.X_W.q.coeffs(), second[i].object.X_W.q.coeffs()) << i;
    ASSERT_EQ(first[i].object.V_W, second[i].object.V_W) << i;
  }
}

// ---- what goes wrong ---------------------------------------------------------------------------

TEST_F(Dart, ReportsAStateThatIsNotFinite) {
  const Scenario s = With(EngineKind::kDart, BoxScene(9));
  World world(s);
  for (const double force : {std::nan(""), HUGE_VAL, 1e300, 1e8}) {
    const Status status = world.Step(Push(s, {0, 0, force}), kTick);
    EXPECT_EQ(status.cause, StopCause::kPhysics) << force;
    EXPECT_EQ(world.EngineFailure(), "") << force;
  }
  EXPECT_TRUE(world.Step(HandsOff(s), kTick).ok());
  EXPECT_NEAR(world.state().time, kTick, 1e-12);
}

// Returns the child processes of this process.
std::vector<pid_t> Children() {
  std::vector<pid_t> children;
  std::ifstream list("/proc/self/task/" + std::to_string(getpid()) + "/children");
  for (pid_t child = 0; list >> child;) children.push_back(child);
  return children;
}

TEST_F(Dart, ReportsThatItsProcessEnded) {
  const Scenario s = With(EngineKind::kDart, BoxScene(9));
  const std::vector<pid_t> before = Children();
  World world(s);
  ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
  const WorldState state = world.state();
  for (const pid_t child : Children())
    if (std::find(before.begin(), before.end(), child) == before.end()) kill(child, SIGKILL);
  const Status status = world.Step(HandsOff(s), kTick);
  EXPECT_EQ(status.cause, StopCause::kPhysics);
  EXPECT_EQ(world.EngineFailure(), "The engine's process ended: signal 9.");
  EXPECT_EQ(world.state().time, state.time);
  EXPECT_EQ(world.state().q, state.q);
  world.Reset();  // starts it again
  EXPECT_TRUE(world.Step(HandsOff(s), kTick).ok());
}

TEST_F(Dart, RefusesByNameWhatItDoesNotHave) {
  Scenario s = With(EngineKind::kDart, BoxScene(9));
  s.simulation.joint_limits = JointLimits::kSoft;
  EXPECT_TRUE(RefusalOf(s).starts_with("simulation.joint_limits | ")) << RefusalOf(s);
  s = With(EngineKind::kDart, BoxScene(9));
  for (const char* event : {"object_breaks_loose", "release_object"}) {
    s.events.resize(1);
    s.events[0].event = event;
    EXPECT_TRUE(RefusalOf(s).starts_with("simulation.engine | ")) << RefusalOf(s);
  }
  s = With(EngineKind::kDart, BoxScene(9));
  s.environment.table = TableSpec{};
  World free(With(EngineKind::kMujoco, BoxScene(9)));
  const Vector3 place = free.state().object.X_W.p;
  s.environment.table->top = place - Vector3(0, 0, 0.09);
  EXPECT_NE(RefusalOf(s).find("touches the floor, the table or a fixture"), std::string::npos)
      << RefusalOf(s);
}

TEST(Mujoco, RefusesHardLimitsByName) {
  Scenario s = BoxScene(9);
  s.simulation.joint_limits = JointLimits::kHard;
  EXPECT_TRUE(RefusalOf(s).starts_with("simulation.joint_limits | ")) << RefusalOf(s);
  s = BoxScene(9);
  s.simulation.velocity_limits = VelocityLimits::kHard;
  EXPECT_TRUE(RefusalOf(s).starts_with("simulation.velocity_limits | ")) << RefusalOf(s);
}

// ---- limits ------------------------------------------------------------------------------------

// Measures the largest position and speed of a sliding attachment that a hand pushes with 60 N for
// a second.
double Slide(Scenario s, JointLimits limits) {
  s.simulation.joint_limits = limits;
  s.environment.gravity = 0;
  s.object.attachment.joint = JointType::kPrismatic;
  s.object.attachment.axis = {1, 0, 0};
  s.object.attachment.range = std::array<double, 2>{-0.05, 0.05};
  World world(s);
  const Pose start = world.state().end_effector.X_W.Inverse() * world.state().object.X_W;
  double largest = 0;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(world.Step(Push(s, {30, 0, 0}), kTick).ok());
    const Pose now = world.state().end_effector.X_W.Inverse() * world.state().object.X_W;
    largest = std::max(largest, (now.p - start.p).norm());
  }
  return largest;
}

TEST_F(Dart, HoldsHardLimitsOfPositions) {
  const Scenario s = With(EngineKind::kDart, BoxScene(9));
  EXPECT_NEAR(Slide(s, JointLimits::kHard), 0.05, 2e-3);
  EXPECT_GT(Slide(s, JointLimits::kNone), 0.1);
}

TEST(Mujoco, HasSoftLimitsOrNone) {
  const Scenario s = BoxScene(9);
  EXPECT_NEAR(Slide(s, JointLimits::kSoft), 0.05, 0.02);
  EXPECT_GT(Slide(s, JointLimits::kNone), 0.1);
}

// Returns the largest speed of the first joint [rad/s] while a torque turns the joint for 0.3 s.
// The other joints stay below their limits. (If several joints are at their limits, DART lets some
// exceed them.)
double FastestTurn(VelocityLimits limits) {
  Scenario s = BoxScene(9);
  s.environment.gravity = 0;
  s.simulation.velocity_limits = limits;
  s.simulation.joint_limits = JointLimits::kNone;
  const ControlledRobot robot(s);
  const ObjectModel object = LoadObject(s.object, s.folder());
  DartProcess dart(DartScene(s, *robot.model, object, kTick));
  dart_engine::Memory& memory = dart.memory();
  std::copy(s.cobot.posture.begin(), s.cobot.posture.end(), memory.state.q);
  memory.state.q[robot.model->dof()] = 1;  // the ball's quaternion
  memory.forces.joint[0] = 80;
  double fastest = 0;
  for (int i = 0; i < 300; ++i) {
    EXPECT_TRUE(dart.Ask(dart_engine::Request::kAdvance)) << dart.Failure();
    fastest = std::max(fastest, std::fabs(memory.state.v[0]));
  }
  return fastest;
}

TEST_F(Dart, HoldsHardLimitsOfVelocities) {
  constexpr double kPandaLimit = 2.175;  // of joint 1 [rad/s]
  EXPECT_GT(FastestTurn(VelocityLimits::kOff), 1.2 * kPandaLimit);
  EXPECT_NEAR(FastestTurn(VelocityLimits::kHard), kPandaLimit, 1e-3);
}

// ---- contact -----------------------------------------------------------------------------------

TEST_F(Dart, LetsTheObjectRestOnTheTable) {
  Scenario s = With(EngineKind::kDart, BoxScene(9));
  World free(s);
  s.environment.table = TableSpec{};
  s.environment.table->size = {2, 2, 0.05};
  s.environment.table->top = free.state().object.X_W.p - Vector3(0, 0, 0.1 + 0.02);
  World world(s);
  const double start = world.state().object.X_W.p.z();
  for (int i = 0; i < 1500; ++i)
    ASSERT_TRUE(world.Step(Push(s, {0, 0, -40}), kTick).ok()) << world.EngineFailure();
  EXPECT_NEAR(world.state().object.X_W.p.z(), start - 0.02, 2e-3);
  EXPECT_LT(world.state().object.V_W.norm(), 0.01);
}

}  // namespace
}  // namespace predictor
