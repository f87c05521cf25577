// The carried object is a gripper that picks up movable objects. Expected values are closed forms,
// or come from a scene in which one body has the masses of both.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/motion.h"
#include "event_fixtures.h"

namespace predictor {
namespace {

constexpr double kGripper = 2, kBrick = 4;  // masses [kg]
constexpr double kBrickWeight = kBrick * kGravity;
constexpr double kClearance = 0.004;    // between gripper and brick at the start [m]
const Vector3 kSize = {0.3, 0.2, 0.1};  // of the brick [m]

MovableSpec BrickAt(const std::string& name, const Vector3& p) {
  MovableSpec brick;
  brick.name = name;
  brick.primitive = PrimitiveSpec{};
  brick.primitive->size = kSize;
  brick.primitive->mass = kBrick;
  brick.xyz = p;
  return brick;
}

// A gripper of 2 kg, whose weight the cobot carries, is above a brick in the air. Its faces are
// along the axes of W.
Scenario AboveABrick() {
  Scenario s = RigidBox();
  s.right_handle->pose.rpy.setZero();
  s.cobot.payload = PayloadSpec{kGripper, {0, 0, 0.1}};
  s.object.attachment.on_end_effector.rpy.z() = -0.785;
  const Pose X_WO = World(s).state().object.X_W;
  s.environment.objects = {BrickAt("brick", X_WO * Vector3(0, 0, -0.1 - kClearance - 0.05))};
  s.environment.objects[0].rpy = {
      0, 0, std::atan2(X_WO.q.toRotationMatrix()(1, 0), X_WO.q.toRotationMatrix()(0, 0))};
  return s;
}

// The brick stands on a table.
Scenario BrickOnATable() {
  Scenario s = AboveABrick();
  FixtureSpec table;
  table.size = {2, 2, 0.1};
  table.xyz = s.environment.objects[0].xyz - Vector3(0, 0, 0.05 + 0.05);
  s.environment.fixtures = {table};
  return s;
}

EventSpec PickUp(double after, std::vector<std::string> parameters = {}) {
  parameters.insert(parameters.begin(), "object=brick");
  return Event("pick_up", after, parameters);
}
EventSpec LetGo(double after) { return Event("let_go", after); }

Pose BrickInGripper(const World& world, std::size_t i = 0) {
  return world.state().object.X_W.Inverse() * world.state().movables.motion[i].X_W;
}
double HeightOf(const World& world, std::size_t i = 0) {
  return world.state().movables.motion[i].X_W.p.z();
}

// One body with the mass, the centre of mass and the inertia of gripper and brick.
PrimitiveSpec Composite(const Scenario& s) {
  const auto inertia = [](double mass, const Vector3& size) {
    const Vector3 s2 = size.cwiseProduct(size);
    return Vector3(mass / 12 * Vector3(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y()));
  };
  const double offset = -0.1 - kClearance - 0.05;
  PrimitiveSpec both = *s.object.primitive;
  both.mass = kGripper + kBrick;
  both.center_of_mass = {0, 0, kBrick * offset / both.mass};
  const double steiner = kGripper * kBrick / both.mass * offset * offset;
  both.inertia =
      inertia(kGripper, both.size) + inertia(kBrick, kSize) + Vector3(steiner, steiner, 0);
  return both;
}

// Without weights, gripper and brick move like one body, whatever the hands do.
TEST(PickUp, BothMoveLikeOneBody) {
  Scenario s = AboveABrick();
  s.environment.gravity = 0;
  Scenario one = s;
  one.environment.objects.clear();
  one.object.primitive = Composite(s);
  s.events = {PickUp(0)};
  World world(s), other(one);
  RunWith(&world, HandsOff(s), 0.2);
  RunWith(&other, HandsOff(s), 0.2);
  WorldInput input = Push(s, {3, -2, 4});
  input.F_H_W[0].head<3>() += Vector3(5, 4, 0);
  const Pose place = BrickInGripper(world);
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(world.Step(input, kTick).ok());
    ASSERT_TRUE(other.Step(input, kTick).ok());
    ASSERT_LT((BrickInGripper(world).p - place.p).norm(), 1e-6);
  }
  EXPECT_GT(other.state().object.V_W.norm(), 0.1);
  // The steps of 1 ms treat the velocities of one body and of two bodies differently.
  EXPECT_LT((world.state().object.X_W.p - other.state().object.X_W.p).norm(), 1e-5);
  EXPECT_LT((world.state().q - other.state().q).norm(), 1e-4);
}

// The grip's force rises to its limit, which is less than the weight. Closed brakes keep the
// gripper where it is.
TEST(PickUp, SlipsWhenItsFrictionIsExceeded) {
  constexpr double kLimit = 0.75 * kBrickWeight, kReach = 0.03;
  Scenario s = AboveABrick();
  s.events = {PickUp(0, {"slip_force=" + std::to_string(kLimit),
                         "slip_distance=" + std::to_string(kReach)}),
              Event("brakes_close")};
  World world(s);
  const double start = HeightOf(world);
  double v = 0, z = 0;
  bool left = false;
  for (int k = 1; k <= 200; ++k) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    // A force per step, as it tightens by 1000 N/s.
    const double force = left ? 0 : std::min(kLimit, k * kTick * 1000);
    v += (force / kBrick - kGravity) * kTick;
    z += v * kTick;
    ASSERT_NEAR(HeightOf(world) - start, z, 2e-3 * std::fabs(z) + 1e-7) << k;
    left = left || world.state().movables.held < 0;
    if (!left) {
      ASSERT_EQ(world.state().movables.grip, AttachmentState::kSlips) << k;
    }
  }
  EXPECT_TRUE(left);
  EXPECT_GT((BrickInGripper(world).p).norm(), 0.15 + kClearance + kReach);
  EXPECT_EQ(world.state().movables.grip, AttachmentState::kOpen);
}

// The hands lift the brick, carry it, and put it down. The cobot carries its weight meanwhile.
TEST(PickUp, CarriesABrickFromATableAndPutsItDown) {
  Scenario s = BrickOnATable();
  s.events = {PickUp(0.1, {"load=4"}), LetGo(3)};
  Vector3 lifted[2];
  for (const bool sideways : {false, true}) {
    World world(s);
    RunWith(&world, HandsOff(s), 0.05);
    EXPECT_EQ(world.state().movables.held, -1);
    RunWith(&world, HandsOff(s), 0.95);
    EXPECT_EQ(world.state().movables.held, 0);
    EXPECT_EQ(world.state().movables.grip, AttachmentState::kHolds);
    const Vector3 before = world.state().movables.motion[0].X_W.p;
    const Pose place = BrickInGripper(world);
    RunWith(&world, Push(s, {sideways ? 0.5 : 0, 0, 8}), 1);
    lifted[sideways] = world.state().movables.motion[0].X_W.p - before;
    EXPECT_GT(lifted[sideways].z(), 0.02);  // 16 N on springs of 500 N/m
    EXPECT_LT((BrickInGripper(world).p - place.p).norm(), 1e-5);
    RunWith(&world, HandsOff(s), 1.5);
    const Vector3 put = world.state().movables.motion[0].X_W.p;
    EXPECT_EQ(world.state().movables.held, -1);
    RunWith(&world, Push(s, {0, 0, 8}), 0.5);
    EXPECT_NEAR(HeightOf(world), before.z(), 1e-4);
    EXPECT_LT((world.state().movables.motion[0].X_W.p - put).norm(), 1e-3);
    EXPECT_GT(world.state().object.X_W.p.z() - HeightOf(world), 0.15 + 0.01);
  }
  EXPECT_GT(lifted[1].x() - lifted[0].x(), 0.01);
}

// It falls like any body, and the cobot, which knows, does not jump.
TEST(PickUp, DropsWhatItHolds) {
  Scenario s = AboveABrick();
  s.events = {PickUp(0, {"load=4", "load_time=0.04"}), LetGo(1.9995)};
  World world(s);
  RunWith(&world, HandsOff(s), 2);
  const double height = HeightOf(world), v = world.state().movables.motion[0].V_W[2];
  const Vector3 E = world.state().end_effector.X_W.p;
  for (int n = 1; n <= 200; ++n) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const double fallen = kGravity * kTick * kTick * n * (n + 1) / 2 - v * n * kTick;
    ASSERT_NEAR(HeightOf(world) - height, -fallen, 1e-7) << n;
  }
  EXPECT_LT((world.state().end_effector.X_W.p - E).norm(), 1e-3);
}

TEST(PickUp, StaysOpenIfTheBrickIsTooFarAway) {
  Scenario s = BrickOnATable();
  s.events = {PickUp(0.1, {"grasp_gap=0.003"}), PickUp(0.3, {"grasp_gap=0.005"})};
  World world(s);
  RunWith(&world, HandsOff(s), 0.2);
  EXPECT_EQ(world.state().movables.grip, AttachmentState::kMissed);
  EXPECT_EQ(world.state().movables.held, -1);
  RunWith(&world, HandsOff(s), 0.3);
  EXPECT_EQ(world.state().movables.grip, AttachmentState::kHolds);
}

// While it holds one brick, it cannot pick up the other one.
TEST(PickUp, TakesOneBrickAfterTheOther) {
  Scenario s = BrickOnATable();
  MovableSpec& first = s.environment.objects[0];
  first.primitive->size = {0.1, 0.1, 0.1};
  first.xyz.x() -= 0.06;
  s.environment.objects.push_back(first);
  s.environment.objects[1].name = "second";
  s.environment.objects[1].xyz.x() += 0.12;
  const EventSpec second = Event("pick_up", 0.3, {"object=second"});
  s.events = {PickUp(0.1), second, LetGo(0.5), second};
  s.events[3].trigger.after = 0.7;
  World world(s);
  std::vector<int> held;
  for (const double until : {0.05, 0.2, 0.4, 0.6, 0.8}) {
    RunWith(&world, HandsOff(s), until - world.state().time);
    held.push_back(world.state().movables.held);
  }
  EXPECT_EQ(held, (std::vector{-1, 0, 0, -1, 1}));
}

TEST(PickUp, ContinuesFromASavedStateBitForBit) {
  Scenario s = BrickOnATable();
  s.cobot.safety.force = 1000;
  s.events = {PickUp(0.1, {"load=4", "slip_force=60"}), LetGo(0.4), PickUp(0.5)};
  const WorldInput input = Push(s, {1, 0, 14});
  for (const double saved_at : {0.05, 0.12, 0.3, 0.45, 0.52, 0.6}) {
    World world(s), other(s);
    RunWith(&other, input, 0.22);  // leaves traces that the loaded state must replace
    RunWith(&world, input, saved_at);
    CopyState(&world, &other);
    for (int round = 0; round < 2; ++round) {
      RunWith(&world, input, 0.3);
      RunWith(&other, input, 0.3);
      EXPECT_EQ((world.state().q - other.state().q).norm(), 0) << saved_at;
      EXPECT_EQ(
          (world.state().movables.motion[0].X_W.p - other.state().movables.motion[0].X_W.p).norm(),
          0)
          << saved_at;
      EXPECT_EQ(world.state().movables.held, other.state().movables.held) << saved_at;
      EXPECT_EQ(world.state().energy, other.state().energy) << saved_at;
      world.Reset();
      other.Reset();
    }
  }
}

// A run after a reset repeats the first one.
TEST(PickUp, AResetOpensTheGripper) {
  Scenario s = BrickOnATable();
  s.events = {PickUp(0.05, {"load=4"})};
  const WorldInput input = Push(s, {1, 0, 14});
  World world(s);
  RunWith(&world, input, 0.4);
  const WorldState first = world.state();
  EXPECT_EQ(first.movables.held, 0);
  world.Reset();
  EXPECT_EQ(world.state().movables.held, -1);
  RunWith(&world, input, 0.4);
  EXPECT_EQ((world.state().q - first.q).norm(), 0);
  EXPECT_EQ((world.state().movables.motion[0].X_W.p - first.movables.motion[0].X_W.p).norm(), 0);
}

TEST(PickUp, TakesNothingFromTheHeap) {
  Scenario s = BrickOnATable();
  s.events = {PickUp(0.05, {"slip_force=30"}), LetGo(0.2), PickUp(0.25)};
  ExpectNoHeap(s, {1, 0, 14}, 400);
}

// The cobot's own safety functions take the weight for a force unless the cobot knows the load.
TEST(PickUp, ItsSafetyFunctionsKnowTheLoad) {
  for (const bool knows : {true, false}) {
    Scenario s = AboveABrick();
    s.cobot.safety.force = 0.8 * kBrickWeight;
    s.events = {PickUp(0, {knows ? "load=4" : "load=0", "load_time=0.04", "slip_force=45"})};
    World world(s);
    RunWith(&world, HandsOff(s), 2);
    EXPECT_EQ(world.state().cobot_stop != 0, !knows);
  }
}

TEST(PickUp, ImpossibleCommandsAreRefused) {
  Scenario s = BrickOnATable();
  s.events = {LetGo(1)};
  EXPECT_EQ(RefusalOf(s),
            "events.0.event | events.0.event is let_go, but no event picks anything up. Add an "
            "event pick_up, or use release_object to let go of the object itself.");
  s.events = {Event("pick_up", 1, {"object=brik"})};
  EXPECT_EQ(RefusalOf(s),
            "events.0.object | events.0.object: no movable object has the name \"brik\". Did you "
            "mean brick?");
  s.events = {PickUp(1), Event("release_object", 2)};
  EXPECT_EQ(RefusalOf(s),
            "events.0.event | events.0.event is pick_up, but another event lets the object itself "
            "slip, break loose or be released. Remove one of them.");
  s.events = {PickUp(1)};
  s.events[0].duration = 2;
  EXPECT_EQ(RefusalOf(s),
            "events.0.duration | events.0.event is pick_up with a duration, but this gripper stays "
            "as it is until the next command. Remove the duration, and use pick_up and let_go.");
}

}  // namespace
}  // namespace predictor
