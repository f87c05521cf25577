// Tests when events begin and end, and what each hazard does to the cobot. Expected values are
// closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "event_fixtures.h"
#include "scenes.h"
#include "simulation/event_sequence.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

Vector3 EndEffector(const World& world) { return world.state().end_effector.X_W.p; }

std::string ErrorOfEvents(const Scenario& s) {
  try {
    World world(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// ---- triggers ----------------------------------------------------------------------------------

struct Moment {
  double time;
  double force;
  double height;
};

// Returns the index of the first moment at which the only event acts, or −1 if it never acts.
int BeginsAt(const TriggerSpec& trigger, const std::vector<Moment>& moments,
             std::uint64_t seed = 1) {
  Scenario s = RigidBox();
  s.seed = seed;
  s.events = {Event("brakes_close")};
  s.events[0].trigger = trigger;
  EventSequence sequence(s);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    WorldState state;
    state.time = moments[i].time;
    state.object.X_W.p.z() = 1 + moments[i].height;
    WorldInput input = Push(s, {0, moments[i].force, 0});
    sequence.Update(state, input);
    if (sequence.active() != 0) return static_cast<int>(i);
  }
  return -1;
}

TEST(Events, BeginWhenAllConditionsHoldAtOnce) {
  TriggerSpec trigger;
  trigger.after = 1;
  EXPECT_EQ(BeginsAt(trigger, {{0, 0, 0}, {0.999, 0, 0}, {1, 0, 0}}), 2);
  trigger.force = 10;
  EXPECT_EQ(BeginsAt(trigger, {{0, 11, 0}, {1, 9, 0}, {2, 10.1, 0}}), 2);
  trigger.place = EventPlaceSpec{{0, 0, 0.1}, 0.02};
  EXPECT_EQ(BeginsAt(trigger, {{0, 0, 0}, {1, 11, 0.07}, {2, 9, 0.1}, {3, 11, 0.119}}), 3);
  trigger = {};
  trigger.gripping = true;
  EXPECT_EQ(BeginsAt(trigger, {{0, 0.4, 0}, {0, 0.6, 0}}), 1);
  trigger.force = 100;
  EXPECT_EQ(BeginsAt(trigger, {{0, 0.4, 0}, {0, 99, 0}}), -1);
}

TEST(Events, DrawTheirTimeFromTheSeed) {
  std::vector<Moment> moments;
  for (int k = 0; k <= 4000; ++k) moments.push_back({k * 1e-3, 0, 0});
  TriggerSpec trigger;
  trigger.after = 1;
  trigger.window = 2;
  double sum = 0, squares = 0;
  const int seeds = 200;
  for (int seed = 1; seed <= seeds; ++seed) {
    const int at = BeginsAt(trigger, moments, static_cast<std::uint64_t>(seed));
    ASSERT_GE(at, 1000);
    ASSERT_LE(at, 3000);
    sum += at * 1e-3, squares += at * at * 1e-6;
  }
  // A uniform distribution in [1 s, 3 s] has the mean 2 s and the standard deviation 1/√3 s.
  const double mean = sum / seeds, deviation = std::sqrt(squares / seeds - mean * mean);
  EXPECT_NEAR(mean, 2, 4 / std::sqrt(3.0 * seeds));
  EXPECT_NEAR(deviation, 1 / std::sqrt(3.0), 0.08);
  EXPECT_EQ(BeginsAt(trigger, moments, 7), BeginsAt(trigger, moments, 7));
}

TEST(Events, HaveAnotherTimeAfterAReset) {
  Scenario s = RigidBox();
  s.events = {Event("brakes_close")};
  s.events[0].trigger.window = 10;
  EventSequence sequence(s);
  const auto begins = [&] {
    for (int k = 0; k <= 10000; ++k) {
      WorldState state;
      state.time = k * 1e-3;
      sequence.Update(state, HandsOff(s));
      if (sequence.active() != 0) return k;
    }
    return -1;
  };
  const int first = begins();
  sequence.Reset();
  const int second = begins();
  EXPECT_GE(second, 0);
  EXPECT_NE(first, second);
}

// Loads the saved sequence with a new seed, and returns the time at which its event then begins
// [s].
double BeginsAfterLoading(const std::vector<std::byte>& state, std::uint64_t seed,
                          const Scenario& s) {
  EventSequence sequence(s);
  StateArchive load = StateArchive::ToLoad(state, seed);
  sequence.Archive(load);
  EXPECT_TRUE(load.ok());
  const WorldInput input = HandsOff(s);
  for (int k = 290; k <= 610; ++k) {
    WorldState world;
    world.time = k * 0.01;
    sequence.Update(world, input);
    if (sequence.active() != 0) return world.time;
  }
  return -1;
}

// The state is saved at 3 s, when a quarter of the window has passed. The times of the new seeds
// are uniformly distributed in the rest of the window, from 3 s to 6 s.
TEST(Events, HaveAnotherTimeAfterANewSeed) {
  Scenario s = RigidBox();
  s.events = {Event("brakes_close", 2)};
  s.events[0].trigger.window = 4;
  EventSequence sequence(s);
  WorldState world;
  world.time = 3;
  sequence.Update(world, HandsOff(s));
  ASSERT_EQ(sequence.active(), 0);  // the scenario's own seed draws a later time
  std::vector<std::byte> state(4096);
  StateArchive save = StateArchive::ToSave(state);
  sequence.Archive(save);
  ASSERT_TRUE(save.ok());
  state.resize(save.used());

  double sum = 0, squares = 0;
  const int seeds = 200;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const double at = BeginsAfterLoading(state, seed, s);
    ASSERT_GE(at, 3);
    ASSERT_LE(at, 6.01);
    sum += at, squares += at * at;
  }
  // A uniform distribution in [3 s, 6 s] has the standard deviation 3/√12 s.
  const double mean = sum / seeds, deviation = std::sqrt(squares / seeds - mean * mean);
  EXPECT_NEAR(mean, 4.5, 4 * 3 / std::sqrt(12.0 * seeds));
  EXPECT_NEAR(deviation, 3 / std::sqrt(12.0), 0.12);
  EXPECT_EQ(BeginsAfterLoading(state, 7, s), BeginsAfterLoading(state, 7, s));
}

TEST(Events, EndAfterTheirDurationAndDoNotRepeat) {
  Scenario s = RigidBox();
  s.events = {Event("wrong_payload", 0.1), Event("brakes_close", 0.2)};
  s.events[0].duration = 0.05;
  EventSequence sequence(s);
  for (int k = 0; k <= 300; k += 10) {
    WorldState state;
    state.time = k * 1e-3;
    const Disturbance d = sequence.Update(state, HandsOff(s));
    EXPECT_EQ(d.payload, k >= 100 && k < 150 ? 2 : 0) << k;
    EXPECT_EQ(d.brakes, k >= 200) << k;
    EXPECT_EQ(sequence.latest(), k < 100   ? 0
                                 : k < 200 ? 12
                                           : 1)
        << k;  // the last of the first twelve, and the first one
  }
}

// ---- effects -----------------------------------------------------------------------------------

// The controller pushes upward with Δm g against its spring of 500 N/m.
TEST(Hazards, WrongPayloadLiftsTheCobotByItsSpring) {
  Scenario s = RigidBox();
  s.events = {Event("wrong_payload", 0, {"payload_error=1.5"})};
  World world(s);
  const double before = EndEffector(world).z();
  RunWith(&world, HandsOff(s), 6);
  EXPECT_NEAR(EndEffector(world).z() - before, 1.5 * kGravity / 500, 2e-4);
}

// Returns the displacement of the end-effector 6 s after a jump of the set-point [m], [rad].
Vector6 MotionAfterJump(const ControllerSpec& controller, const std::string& xyz,
                        const std::string& rotation) {
  Scenario s = RigidBox();
  s.cobot.controller = controller;
  s.events = {Event("set_point_jump", 0, {"xyz=" + xyz, "rotation=" + rotation})};
  World world(s);
  const Pose before = world.state().end_effector.X_W;
  RunWith(&world, HandsOff(s), 6);
  return PoseError(world.state().end_effector.X_W, before);
}

ControllerSpec ControllerWith(const std::string& type,
                              const std::vector<std::string>& parameters = {}) {
  ControllerSpec controller = {type, {}};
  for (const std::string& p : parameters) controller.Set(p);
  return controller;
}

// The springs lead the cobot to the new set-point, except along the axes of hybrid control whose
// force is set.
TEST(Hazards, SetPointJumpMovesTheCobotByTheJump) {
  const ControllerSpec impedance = RigidBox().cobot.controller,
                       admittance = ControllerWith(
                           "admittance", {"virtual_stiffness={translation: [300, 300, 300], "
                                          "rotation: [20, 20, 20]}"}),
                       hybrid =
                           ControllerWith("hybrid_force_position", {"set_force=[0, 0, 19.62]"});
  for (const ControllerSpec& controller : {impedance, admittance}) {
    const Vector6 moved = MotionAfterJump(controller, "[0, 0, 0.04]", "[0, 0, 0.1]");
    EXPECT_NEAR(moved[2], 0.04, 5e-4) << controller.type;
    EXPECT_NEAR(moved[5], 0.1, 3e-3) << controller.type;
  }
  const Vector6 moved = MotionAfterJump(hybrid, "[0.03, 0, 0.04]", "[0, 0, 0.1]");
  EXPECT_NEAR(moved[0], 0.03, 1e-3);
  EXPECT_LT(std::abs(moved[2]), 0.01);
  EXPECT_NEAR(moved[5], 0.1, 3e-3);
}

// Gravity compensation with a virtual fixture keeps its orientation with a spring.
TEST(Hazards, SetPointJumpTurnsControllersThatKeepAnOrientation) {
  for (const char* type : {"load_sharing", "virtual_fixtures"}) {
    const ControllerSpec controller = type == std::string("load_sharing")
                                          ? ControllerWith(type, {"share=1", "object_mass=2"})
                                          : ControllerWith(type, {"object_mass=2"});
    EXPECT_NEAR(MotionAfterJump(controller, "[0, 0, 0]", "[0, 0, 0.1]")[5], 0.1, 3e-3) << type;
  }
}

TEST(Hazards, SetPointJumpIsRefusedWhereNoSpringRespondsToIt) {
  const auto error = [](const ControllerSpec& controller, const std::string& xyz) {
    Scenario s = RigidBox();
    s.cobot.controller = controller;
    s.events = {Event("set_point_jump", 0, {"xyz=" + xyz})};
    return ErrorOfEvents(s);
  };
  EXPECT_EQ(error(ControllerWith("admittance"), "[0, 0, 0.05]"),
            "events.0.event is set_point_jump, which would have no effect, because the controller "
            "admittance has no spring that pulls the end-effector to a set-point in space. Remove "
            "the event, or change the cobot.");
  EXPECT_EQ(
      error(ControllerWith("hybrid_force_position", {"set_force=[0, 0, 19.62]"}), "[0, 0, 0.05]"),
      "events.0.event is set_point_jump, which would have no effect, because the controller "
      "hybrid_force_position has no spring that pulls the end-effector along or about an "
      "axis of this jump. Remove the event, or change the cobot.");
  EXPECT_NE(error(ControllerWith("joint_impedance"), "[0, 0, 0.05]").find("joint_impedance has no"),
            std::string::npos);
  EXPECT_EQ(error(RigidBox().cobot.controller, "[0, 0, 0.05]"), "");
  EXPECT_NE(error(RigidBox().cobot.controller, "[0, 0, 0]").find("no effect"), std::string::npos);
}

// The spring already carries the weight of 2 kg. If the spring's stiffness becomes three times as
// large, the cobot must rise by two thirds of the deflection.
TEST(Hazards, StiffnessStepChangesTheForceAtOnce) {
  Scenario s = RigidBox();
  s.events = {Event("stiffness_step", 0, {"translation_factor=3", "rotation_factor=1"})};
  World world(s);
  const double before = EndEffector(world).z();
  RunWith(&world, HandsOff(s), 6);
  EXPECT_NEAR(EndEffector(world).z() - before, 2 * kGravity / 500 * (1 - 1.0 / 3), 3e-4);
}

TEST(Hazards, ClosedBrakesHoldTheCobotAgainstAPush) {
  Scenario s = RigidBox();
  s.events = {Event("brakes_close")};
  World world(s);
  const Vector3 before = EndEffector(world);
  RunWith(&world, Push(s, {0, 0, -15}), 2);
  EXPECT_EQ(world.state().torque.norm(), 0);
  EXPECT_LT((EndEffector(world) - before).norm(), 1e-3);
  EXPECT_LT(world.state().v.lpNorm<Eigen::Infinity>(), 1e-3);
}

// Without torque, the cobot's tree accelerates as its weight demands, almost uniformly in the first
// 20 ms. The end-effector falls.
TEST(Hazards, PowerLossLetsTheCobotSinkUntilItsBrakesClose) {
  Scenario s = RigidBox();
  s.cobot.joint_friction = {};
  s.events = {Event("power_loss", 0, {"brake_delay=0.1"})};
  World world(s);
  const double start = EndEffector(world).z();
  RunWith(&world, HandsOff(s), 0.1);
  const double sunk = start - EndEffector(world).z();
  EXPECT_GT(sunk, 0.005);
  RunWith(&world, HandsOff(s), 1);
  const double rest = EndEffector(world).z();
  RunWith(&world, HandsOff(s), 1);
  EXPECT_NEAR(EndEffector(world).z(), rest, 1e-3);
}

TEST(Hazards, FrozenControllerKeepsItsTorque) {
  Scenario s = RigidBox();
  s.events = {Event("control_freeze", 0.5)};
  s.events[0].duration = 0.2;
  World world(s);
  const WorldInput push = Push(s, {0, 0, -3});
  RunWith(&world, push, 0.5);
  const JointVector held = world.state().torque;
  for (int k = 0; k < 199; ++k) {
    ASSERT_TRUE(world.Step(push, kTick).ok());
    ASSERT_EQ((world.state().torque - held).norm(), 0) << k;
  }
  RunWith(&world, push, 0.01);
  EXPECT_GT((world.state().torque - held).norm(), 1e-3);
}

// The torque that acts must be the one computed 20 sub-steps earlier. The state hardly changes
// during these sub-steps.
TEST(Hazards, AddedDelayDelaysTheTorque) {
  Scenario s = RigidBox();
  s.events = {Event("set_point_jump", 0.1, {"xyz=[0, 0, 0.01]"}),
              Event("control_delay", 0, {"added_delay=0.02"})};
  World world(s);
  RunWith(&world, HandsOff(s), 0.1);
  const JointVector before = world.state().torque;
  RunWith(&world, HandsOff(s), 0.020);  // up to 19 sub-steps after the jump
  EXPECT_LT((world.state().torque - before).norm(), 1e-6);
  RunWith(&world, HandsOff(s), 0.002);
  EXPECT_GT((world.state().torque - before).norm(), 0.5);
}

// An admittance cobot must yield to the bias with the steady speed F / D.
TEST(Hazards, SensorBiasMakesAnAdmittanceCobotDrift) {
  Scenario s = RigidBox();
  s.left_handle->pose = {};
  s.cobot.controller = {"admittance", {}};
  s.events = {Event("sensor_bias", 0, {"force_bias=[0, 0, 3]"})};
  World world(s);
  RunWith(&world, HandsOff(s), 2);
  const double v = world.state().end_effector.V_W.z();
  EXPECT_NEAR(v, 3.0 / 60, 2e-3);
}

TEST(Hazards, SensorDriftGrows) {
  Scenario s = RigidBox();
  s.cobot.controller = {"admittance", {}};
  s.events = {Event("sensor_drift", 1, {"force_drift=[0, 0, 2]"})};
  EventSequence sequence(s);
  WorldState state;
  for (const double time : {0.0, 1.0, 3.5}) {
    state.time = time;
    EXPECT_DOUBLE_EQ(sequence.Update(state, HandsOff(s)).sensor[2], 2 * std::max(0.0, time - 1));
  }
}

// Over-compensated Coulomb friction must accelerate each joint in the direction in which it moves.
TEST(Hazards, WrongFrictionAddsTorqueAlongTheMotion) {
  Scenario s = RigidBox();
  s.events = {Event("wrong_friction", 0, {"coulomb_error=2", "viscous_error=0.5"})};
  Scenario plain = s;
  plain.events.clear();
  World disturbed(s), undisturbed(plain);
  const WorldInput push = Push(s, {5, 5, 5});
  ASSERT_TRUE(disturbed.Step(push, kTick).ok());
  // at rest, the torques were the same, so the states are equal
  ASSERT_TRUE(undisturbed.Step(push, kTick).ok());
  ASSERT_EQ((disturbed.state().v - undisturbed.state().v).norm(), 0);
  const JointVector v = undisturbed.state().v;
  ASSERT_TRUE(disturbed.Step(push, kTick).ok());
  ASSERT_TRUE(undisturbed.Step(push, kTick).ok());
  for (int j = 0; j < v.size(); ++j)
    EXPECT_NEAR(disturbed.state().torque[j] - undisturbed.state().torque[j],
                2 * std::tanh(v[j] / 0.01) + 0.5 * v[j], 1e-12)
        << j;
}

TEST(Hazards, TakeoverHandsOverToTheStandbyController) {
  Scenario s = RigidBox();
  s.cobot.standby_controller = ControllerSpec{"gravity_compensation", {}};
  s.events = {Event("takeover", 0.1)};
  World world(s);
  RunWith(&world, HandsOff(s), 0.1);
  const JointVector before = world.state().torque;
  ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
  ControlledRobot robot(s);
  robot.Update(world.state().q, JointVector::Zero(7));
  EXPECT_LT((world.state().torque - robot.data.gravity()).norm(), 1e-3);
  EXPECT_GT((world.state().torque - before).norm(), 1);
}

// The admittance's reference must begin where the torques continue, not at the posture from which
// the cobot sagged.
TEST(Hazards, TakeoverByAnAdmittanceContinuesTheTorque) {
  Scenario s = RigidBox();
  s.cobot.standby_controller = ControllerSpec{"admittance", {}};
  s.events = {Event("takeover", 0.1)};
  World world(s);
  RunWith(&world, HandsOff(s), 0.1);
  const JointVector before = world.state().torque;
  ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
  EXPECT_LT((world.state().torque - before).norm(), 0.05);
  RunWith(&world, HandsOff(s), 1);
  EXPECT_LT(world.state().end_effector.V_W.head<3>().norm(), 0.02);
}

// ---- reset, saved state, bad input -------------------------------------------------------------

std::vector<Scenario> Disturbed() {
  std::vector<Scenario> all;
  for (const char* event :
       {"brakes_close", "control_delay", "control_freeze", "damping_step", "power_loss",
        "set_point_jump", "stiffness_step", "takeover", "wrong_friction", "wrong_payload"}) {
    all.push_back(RigidBox());
    all.back().cobot.standby_controller = ControllerSpec{"joint_impedance", {}};
    all.back().events = {Event(event, 0.05)};
    all.back().events[0].duration = 0.1;
  }
  for (const char* type : {"admittance", "hybrid_force_position"}) {
    all.push_back(RigidBox());
    all.back().cobot.controller =
        ControllerWith(type, {type == std::string("admittance")
                                  ? "virtual_stiffness={translation: [300, 300, 300]}"
                                  : "set_force=[0, 0, 19.62]"});
    all.back().events = {Event("set_point_jump", 0.05, {"xyz=[0.03, 0, 0]"})};
    all.back().events[0].duration = 0.1;
  }
  for (const char* event : {"sensor_bias", "sensor_drift"}) {
    all.push_back(RigidBox());
    all.back().cobot.controller = {"admittance", {}};
    all.back().events = {Event(event, 0.05)};
  }
  for (const bool senses : {false, true}) {
    all.push_back(RigidBox());
    if (senses) all.back().cobot.controller = {"admittance", {}};
    all.back().events = {Event("object_breaks_loose", 0.05)};
    all.push_back(all.back());
    all.back().events = {Event("object_slips", 0.05, {"slip_force=12", "slip_torque=0.1"})};
    all.back().events[0].duration = 0.08;
  }
  return all;
}

TEST(Hazards, AreUndoneByReset) {
  for (const Scenario& s : Disturbed()) {
    World world(s);
    const WorldInput push = Push(s, {1, 2, 3});
    RunWith(&world, push, 0.12);
    const JointVector first = world.state().q;
    world.Reset();
    EXPECT_EQ(world.state().events, 0);
    RunWith(&world, push, 0.12);
    EXPECT_EQ((world.state().q - first).norm(), 0) << s.events[0].event;
  }
}

TEST(Hazards, ContinueFromASavedStateBitForBit) {
  for (const Scenario& s : Disturbed()) {
    for (const double saved_at : {0.02, 0.1}) {
      World world(s), other(s);
      const WorldInput push = Push(s, {1, 2, 3});
      RunWith(&world, push, saved_at);
      CopyState(&world, &other);
      RunWith(&world, push, 0.15);
      RunWith(&other, push, 0.15);
      EXPECT_EQ((world.state().q - other.state().q).norm(), 0) << s.events[0].event << saved_at;
      EXPECT_EQ((world.state().torque - other.state().torque).norm(), 0) << s.events[0].event;
      EXPECT_EQ(world.state().events, other.state().events);
    }
  }
}

TEST(Hazards, ThatWouldHaveNoEffectAreRefused) {
  Scenario s = RigidBox();
  s.events = {Event("sensor_bias")};
  EXPECT_EQ(ErrorOfEvents(s),
            "events.0.event is sensor_bias, which would have no effect, because cobot.controller "
            "does not use a wrist sensor. Remove the event, or change the cobot.");
  s.events = {Event("brakes_close"), Event("takeover")};
  EXPECT_NE(ErrorOfEvents(s).find("events.1.event is takeover"), std::string::npos);
  s.cobot.controller = {"gravity_compensation", {}};
  s.object.attachment.joint = JointType::kFixed;
  s.environment.gravity = 0;
  for (const char* event : {"set_point_jump", "stiffness_step", "damping_step"}) {
    s.events = {Event(event)};
    EXPECT_NE(ErrorOfEvents(s).find("would have no effect"), std::string::npos) << event;
  }
  s.events = {Event("earthquake")};
  EXPECT_NE(ErrorOfEvents(s).find("there is no event \"earthquake\""), std::string::npos)
      << ErrorOfEvents(s);
}

}  // namespace
}  // namespace predictor
