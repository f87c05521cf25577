// Tests the commands on which the cobot puts the object down and grasps it again. Expected values
// are closed forms or come from the same scene without these events.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "event_fixtures.h"

namespace predictor {
namespace {

constexpr double kMass = 2;        // of the box [kg]
constexpr double kFriction = 0.3;  // of the table
constexpr double kWeight = kMass * kGravity;
// Below this speed per unit of friction, a fixture's friction is weaker than Coulomb's law states
// (docs/how-to/fixtures.md) [m/s].
constexpr double kWeakFriction = 0.05;
constexpr double kGap = 1e-4;  // between box and table at the start [m]

// Returns a scenario in which a box is fixed to the flange of a cobot that compensates its load, so
// that nothing sags.
Scenario KnownLoad() {
  Scenario s = RigidBox();
  s.cobot.payload = PayloadSpec{kMass, {0, 0, 0.1}};
  return s;
}

// The box of that cobot is just above a table.
Scenario OnATable() {
  Scenario s = KnownLoad();
  s.right_handle->pose.rpy.setZero();
  s.object.attachment.on_end_effector.rpy.z() = -0.785;  // its faces are along the axes of W
  FixtureSpec table;
  table.size = {2, 2, 0.1};
  table.xyz = World(s).state().object.X_W.p - Vector3(0, 0, 0.1 + 0.05 + kGap);
  table.friction = kFriction;
  s.environment.fixtures = {table};
  return s;
}

EventSpec Release(double after) { return Event("release_object", after); }
EventSpec Grasp(double after, const std::vector<std::string>& parameters = {}) {
  return Event("grasp_object", after, parameters);
}

Pose ObjectInFlange(const World& world) {
  return world.state().end_effector.X_W.Inverse() * world.state().object.X_W;
}

// Returns the input of two hands whose pushes together are the fraction `share` of the friction of
// a box that rests on the table with its full weight.
WorldInput PushAgainstFriction(const Scenario& s, double share) {
  return Push(s, {share * kFriction * kWeight / 2, 0, 0});
}

TEST(Payload, TheCobotThatKnowsItsLoadDoesNotSag) {
  Scenario s = RigidBox();
  s.environment.gravity = 0;
  const double level = World(s).state().end_effector.X_W.p.z();
  EXPECT_NEAR(World(RigidBox()).state().end_effector.X_W.p.z(), level - kWeight / 500, 3e-4);
  EXPECT_NEAR(World(KnownLoad()).state().end_effector.X_W.p.z(), level, 1e-6);
  s = KnownLoad();
  s.cobot.payload->mass = 0.5 * kMass;
  EXPECT_NEAR(World(s).state().end_effector.X_W.p.z(), level - 0.5 * kWeight / 500, 3e-4);
}

// The cobot compensates a load only while it holds the load.
TEST(Gripper, TheObjectFallsAndTheCobotStaysWhereItIs) {
  Scenario s = KnownLoad();
  s.events = {Release(0.1)};
  World world(s);
  const WorldState start = world.state();
  RunWith(&world, HandsOff(s), 0.1);
  EXPECT_EQ(world.state().attachment, AttachmentState::kHolds);
  for (int n = 1; n <= 300; ++n) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const double fallen = kGravity * kTick * kTick * n * (n + 1) / 2;
    ASSERT_NEAR(world.state().object.X_W.p.z() - start.object.X_W.p.z(), -fallen, 1e-8) << n;
  }
  EXPECT_LT((world.state().end_effector.X_W.p - start.end_effector.X_W.p).norm(), 1e-7);
  EXPECT_EQ(world.state().attachment, AttachmentState::kOpen);
}

TEST(Gripper, TheTableCarriesTheReleasedObject) {
  Scenario s = OnATable();
  s.events = {Release(0.1)};
  for (const double share : {0.9, 1.3}) {
    World world(s);
    RunWith(&world, HandsOff(s), 0.3);
    const Vector3 start = world.state().object.X_W.p;
    const WorldState before = world.state();
    EXPECT_LT(before.object.V_W.norm(), 1e-5);
    constexpr double kTime = 0.5;  // [s]
    RunWith(&world, PushAgainstFriction(s, share), kTime);
    const Vector3 moved = world.state().object.X_W.p - start;
    const double a = (share - 1) * kFriction * kGravity;
    EXPECT_NEAR(moved.z(), 0, 1e-4);
    if (share < 1)
      EXPECT_LT(moved.norm(), 1e-3);
    else {
      const double slid = a * kTime * kTime / 2;
      EXPECT_GT(moved.x(), slid);
      EXPECT_LT(moved.x(), slid + kWeakFriction * kFriction * kTime);
    }
    EXPECT_LT(world.state().end_effector.V_W.norm(), 1e-6);
  }
}

// The object is moved on the table between release and grasp. The grip must then hold the object at
// its new place, without a jump.
TEST(Gripper, ClosesWhereTheObjectIs) {
  Scenario s = OnATable();
  s.events = {Release(0.1), Grasp(0.6)};
  World world(s);
  const Pose first = ObjectInFlange(world);
  RunWith(&world, HandsOff(s), 0.1);
  RunWith(&world, PushAgainstFriction(s, 1.3), 0.15);
  RunWith(&world, HandsOff(s), 0.35);
  const Pose place = ObjectInFlange(world);
  EXPECT_GT((place.p - first.p).norm(), 0.005);
  EXPECT_LT((place.p - first.p).norm(), 0.03);
  double fastest = 0, slid = 0;
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    fastest = std::max(fastest, world.state().object.V_W.head<3>().norm());
    slid = std::max(slid, (ObjectInFlange(world).p - place.p).norm());
  }
  EXPECT_EQ(world.state().attachment, AttachmentState::kHolds);
  EXPECT_LT(fastest, 5e-3);  // a return to the first place would be a hundred times faster
  EXPECT_LT(slid, 1e-5);
  const double height = world.state().object.X_W.p.z();
  for (int k = 0; k < 500; ++k) {
    ASSERT_TRUE(world.Step(Push(s, {1, 0, 8}), kTick).ok());
    slid = std::max(slid, (ObjectInFlange(world).p - place.p).norm());
  }
  EXPECT_GT(world.state().object.X_W.p.z(), height + 0.01);
  EXPECT_LT(slid, 1e-5);
}

// The cobot must carry the same mass as before. The cobot's springs must be relaxed again, and a
// push must move the cobot like one that never released the object.
TEST(Gripper, HoldsTheSameMassAgain) {
  const Scenario without = KnownLoad();
  Scenario s = without;
  s.events = {Release(0.1), Grasp(0.101)};
  World world(s), other(without);
  RunWith(&world, HandsOff(s), 4);
  RunWith(&other, HandsOff(s), 4);
  const auto height = [](const World& w) { return w.state().end_effector.X_W.p.z(); };
  EXPECT_EQ(world.state().attachment, AttachmentState::kHolds);
  EXPECT_NEAR(height(world), height(other), 1e-4);
  RunWith(&world, Push(s, {0, 0, 6}), 0.05);
  RunWith(&other, Push(s, {0, 0, 6}), 0.05);
  const double v = other.state().object.V_W.z();
  EXPECT_GT(v, 0.02);
  EXPECT_NEAR(world.state().object.V_W.z(), v, 0.01 * v);
}

TEST(Gripper, StaysOpenIfTheObjectIsTooFarAway) {
  for (const bool turned : {false, true}) {
    Scenario s = OnATable();
    s.events = {Release(0.1), Grasp(0.6, {turned ? "grasp_angle=0.02" : "grasp_distance=0.005"}),
                Grasp(0.9)};
    World world(s);
    RunWith(&world, HandsOff(s), 0.1);
    WorldInput push = PushAgainstFriction(s, turned ? 1.6 : 1.3);
    if (turned) push.F_H_W[1] = -push.F_H_W[1];
    RunWith(&world, push, 0.15);
    RunWith(&world, HandsOff(s), 0.55);
    EXPECT_EQ(world.state().attachment, AttachmentState::kMissed) << turned;
    RunWith(&world, HandsOff(s), 0.6);
    EXPECT_EQ(world.state().attachment, AttachmentState::kHolds) << turned;
  }
}

// A second release and grasp must have the same effect as the first ones.
TEST(Gripper, OpensAndClosesRepeatedly) {
  Scenario s = OnATable();
  s.events = {Release(0.1), Grasp(0.3), Release(1.2), Grasp(1.4)};
  World world(s);
  std::vector<AttachmentState> states;
  for (const double until : {0.05, 0.2, 1.1, 1.3, 2.2}) {
    RunWith(&world, HandsOff(s), until - world.state().time);
    states.push_back(world.state().attachment);
  }
  using enum AttachmentState;
  EXPECT_EQ(states, (std::vector{kHolds, kOpen, kHolds, kOpen, kHolds}));
}

TEST(Gripper, ContinuesFromASavedStateBitForBit) {
  for (const JointType joint : {JointType::kFixed, JointType::kSpherical}) {
    Scenario s = OnATable();
    s.object.attachment.joint = joint;
    s.cobot.safety.force = 1000;
    s.events = {Release(0.1), Grasp(0.2, {"grasp_distance=0.0001"}), Grasp(0.3)};
    const WorldInput input = PushAgainstFriction(s, 1.1);
    for (const double saved_at : {0.05, 0.15, 0.25, 0.32, 0.6}) {
      World world(s), other(s);
      RunWith(&other, input, 0.22);  // leaves traces that the loaded state must replace
      RunWith(&world, input, saved_at);
      CopyState(&world, &other);
      for (int round = 0; round < 2; ++round) {
        RunWith(&world, input, 0.4);
        RunWith(&other, input, 0.4);
        EXPECT_EQ((world.state().q - other.state().q).norm(), 0) << saved_at;
        EXPECT_EQ((world.state().object.X_W.p - other.state().object.X_W.p).norm(), 0) << saved_at;
        EXPECT_EQ(world.state().attachment, other.state().attachment) << saved_at;
        world.Reset();
        other.Reset();
      }
    }
  }
}

TEST(Gripper, TakesNothingFromTheHeap) {
  Scenario s = OnATable();
  s.events = {Release(0.05), Grasp(0.1)};
  ExpectNoHeap(s, {0.2, 0, 0}, 300);
}

// The cobot knows that it put its load down, so its own safety functions must not interpret the
// missing weight as a force. If the object breaks loose, the safety functions must interpret the
// missing weight as a force.
TEST(Gripper, ItsSafetyFunctionsKnowWhatItHolds) {
  for (const bool on_purpose : {true, false}) {
    Scenario s = OnATable();
    s.cobot.safety.force = 0.8 * kWeight;
    s.events = {on_purpose ? Release(0.1) : Event("object_breaks_loose", 0.1)};
    World world(s);
    RunWith(&world, HandsOff(s), 1);
    EXPECT_EQ(world.state().cobot_stop != 0, !on_purpose);
  }
}

std::string Error(const Scenario& s) {
  try {
    World world(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Gripper, ImpossibleCommandsAreRefused) {
  Scenario s = RigidBox();
  s.events = {Grasp(1)};
  EXPECT_EQ(Error(s),
            "events.0.event is grasp_object, but the gripper is closed from the start. Add an "
            "event release_object before this event.");
  s.events = {Release(1), Grasp(2)};
  s.object.attachment.joint = JointType::kRevolute;
  EXPECT_EQ(Error(s),
            "events.1.event is grasp_object, but only a fixed or a spherical attachment can close "
            "again. Change object.attachment.joint, or remove the event.");
  s = RigidBox();
  s.events = {Release(1)};
  s.events[0].duration = 1;
  EXPECT_EQ(Error(s),
            "events.0.event is release_object with a duration, but a gripper stays open until an "
            "event closes it. Remove the duration, and add an event grasp_object.");
}

}  // namespace
}  // namespace predictor
