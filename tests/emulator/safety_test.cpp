// Tests the paper's Fig. 9 and related cases: the causes and times of stops, and how the arms come
// to rest.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/motion.h"
#include "emulator/placement.h"
#include "models/robot.h"
#include "runs.h"
#include "scenario/stop_budget.h"
#include "support/soak.h"

namespace predictor {
namespace {

double Force(const HandRecord& hand) {
  return Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]).norm();
}

TEST(Stop, APushEndsByForceInTheTickInWhichItIsSeen) {
  std::optional<TickRecord> decision;
  double before = 0;  // largest estimated force before the stop [N]
  const TestRun run = RunScenario("push", {}, [&](const TickRecord& record) {
    if (record.cause != StopCause::kNone) {
      if (!decision) decision = record;
      return;
    }
    for (const HandRecord& hand : record.hands) before = std::max(before, Force(hand));
  });
  ASSERT_EQ(run.end, RunEnd::kStopped);
  EXPECT_EQ(run.summary.stops.front().cause, StopCause::kForce);
  ASSERT_TRUE(decision);
  EXPECT_LE(before, 30);
  EXPECT_GT(Force(decision->hands[static_cast<std::size_t>(decision->cause_hand)]), 30);
  EXPECT_EQ(decision->state, RunState::kStopping);
  ASSERT_TRUE(run.summary.stops.front().detection);
  // The bound includes the sensor's low-pass filter and delay (force_sensor_test.cpp).
  EXPECT_LE(*run.summary.stops.front().detection, 0.003 + 1e-9);
}

TEST(Stop, AnUnderdampedCobotEndsByOscillationOrElseByForce) {
  EXPECT_EQ(RunScenario("underdamped").summary.stops.front().cause, StopCause::kOscillation);
  const TestRun unwatched = RunScenario("underdamped", {"safety.oscillation.enabled=false"});
  ASSERT_FALSE(unwatched.summary.stops.empty());
  EXPECT_EQ(unwatched.summary.stops.front().cause, StopCause::kForce);
}

TEST(Stop, TheSameScriptPassesWithDamping) {
  const TestRun run = RunScenario("underdamped", {"cobot.controller.damping_ratio=0.7"});
  EXPECT_EQ(run.end, RunEnd::kFinished);
}

// Circles, transports and a release must not cause a stop, whatever the noise and the pace of the
// hand are.
TEST(Stop, NormalWorkRaisesNoAlarmSoak) {
  for (long seed = 1; seed <= Count(3, 50); ++seed)
    for (const char* name : {"box_9kg", "box_18kg", "bar_circle", "dual_ur5"}) {
      const TestRun run = RunScenario(name, {"seed=" + std::to_string(seed)});
      EXPECT_EQ(run.end, RunEnd::kFinished)
          << name << ", seed " << seed << ": " << Name(run.stop.status.cause) << " at "
          << run.stop.time << " s";
    }
}

// The scenario is box_9kg with a script that moves back and forth along y, each time 2 cm farther
// than before.
std::vector<std::string> ToAndFro(double duration) {
  const auto number = [](double x) { return std::to_string(x); };
  std::string script = "[{action: grip, start: 0, duration: 0.5}";
  double at = 1;
  for (int k = 1; k <= 5; ++k, at += 1.1 * duration)
    script += ", {action: move, start: " + number(at) + ", duration: " + number(duration) +
              ", by: [0, " + number((k % 2 ? 0.02 : -0.02) * k) + ", 0]}";
  return {"operator.script=" + script + "]", "duration=" + number(at)};
}

// A scripted motion differs from an oscillation in that it is slower (docs/developer/decisions.md).
// Outside the frequency band, growth does not count. Inside the band, the monitor stops a motion at
// 0.5 Hz whose force grows, whatever the reason for the growth is.
TEST(Stop, AScriptsMotionIsNotAnOscillationUnlessAsFast) {
  EXPECT_EQ(RunScenario("box_9kg", ToAndFro(1.6)).end, RunEnd::kFinished);
  EXPECT_EQ(RunScenario("box_9kg", ToAndFro(2.5)).end, RunEnd::kFinished);
}

// One common factor must bring both arms to rest, and the arms must stay at rest.
TEST(Stop, ScalesBothArmsByOneFactor) {
  std::vector<TickRecord> records;
  RunScenario("push", {}, [&](const TickRecord& record) {
    if (record.state == RunState::kStopping || record.state == RunState::kHeld ||
        record.run_time > 8)
      records.push_back(record);
  });
  std::size_t k = 0;
  while (records[k].cause == StopCause::kNone) ++k;
  using Joints = Eigen::Map<const Eigen::Matrix<double, 7, 1>>;
  const TickRecord& last = records[k - 1];
  double before = 2;
  for (; k < records.size(); ++k) {
    std::array<double, kHands> factor;
    for (std::size_t i = 0; i < kHands; ++i) {
      const Joints start(last.hands[i].command.data()), now(records[k].hands[i].command.data());
      factor[i] = start.dot(now) / start.squaredNorm();
      // The change of the arms' geometry has little effect, because they move only 2 cm.
      EXPECT_LE((now - factor[i] * start).norm(), 0.06 * start.norm()) << "tick " << k;
    }
    EXPECT_NEAR(factor[0], factor[1], 0.02) << "tick " << k;
    EXPECT_LE(factor[0], before + 0.01);
    before = factor[0];
  }
  for (const HandRecord& hand : records.back().hands)
    for (const double v : hand.command) EXPECT_EQ(v, 0);
}

TEST(Stop, StaysStoppedUntilReset) {
  const Scenario scenario = LoadTestScenario("push");
  Emulator emulator(scenario);
  Simulate(&emulator, scenario.duration, [](const TickRecord&) {});
  ASSERT_EQ(emulator.state(), RunState::kHeld);
  const double stopped_at = emulator.run_time();
  for (int k = 0; k < 500; ++k) {
    emulator.Request(RunEvent::kStartRequested);
    emulator.Request(RunEvent::kAlignRequested);
    emulator.Tick();
    ASSERT_EQ(emulator.state(), RunState::kHeld);
  }
  EXPECT_EQ(emulator.run_time(), stopped_at);  // simulated time is paused
  emulator.Request(RunEvent::kReset);
  emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kIdle);
  EXPECT_EQ(emulator.record().cause, StopCause::kNone);
  EXPECT_EQ(emulator.run_time(), 0);
}

double Torque(const HandRecord& hand) {
  return Vector3(hand.wrench[3], hand.wrench[4], hand.wrench[5]).norm();
}

// The same conditions apply to real arms: free hands, handles at rest, and half a second without
// the cause. The test requests a reset in each tick, and every request but the last must be refused
// with a reason.
TEST(Reset, OfASimulatedRigWaitsForItsConditions) {
  for (const bool by_force : {true, false}) {
    Emulator emulator(by_force ? LoadTestScenario("push")
                               : LoadTestScenario("box_9kg", {"operator.hand.release_time=0.5"}));
    int wrong = -1, loaded = -1, moved = -1;  // last tick with each condition
    std::array<int, kRefusals> refused = {};
    int tick = 0;
    for (; tick < 30'000; ++tick) {
      const bool stops = !by_force && emulator.run_time() > 3;
      if (stops && emulator.state() == RunState::kRun) emulator.Request(RunEvent::kStopRequested);
      const bool at_rest = emulator.state() == RunState::kHeld;
      if (at_rest) emulator.Request(RunEvent::kReset);
      emulator.Tick();
      const TickRecord& record = emulator.record();
      // the decision uses the samples of the tick before
      if (at_rest && emulator.state() == RunState::kIdle) break;
      for (const HandRecord& hand : record.hands) {
        if (Force(hand) > 30 || Torque(hand) > 5) wrong = tick;
        if (Force(hand) > 5 || Torque(hand) > 1) loaded = tick;
        if (HandleSpeed(Eigen::Map<const Twist>(hand.real.twist.data())) >= 0.01) moved = tick;
      }
      AutoStart(&emulator);
      if (!at_rest) continue;
      ASSERT_EQ(record.refused, 1 + static_cast<int>(RunEvent::kReset));
      ++refused[record.why_refused];
      ASSERT_EQ(record.state, RunState::kHeld);
    }
    ASSERT_LT(tick, 30'000);
    EXPECT_LT(loaded, tick - 1);
    EXPECT_LT(moved, tick - 1);
    EXPECT_EQ(refused[static_cast<std::size_t>(Refusal::kNone)], 0);
    if (by_force) {
      // The program accepts the reset in the first tick after half a second, because the decision
      // uses the samples of the previous tick.
      EXPECT_NEAR(tick - wrong, 501, 1.5);
      EXPECT_GT(refused[static_cast<std::size_t>(Refusal::kCauseRemains)], 0);
    } else {
      EXPECT_EQ(wrong, -1);
      EXPECT_EQ(tick, loaded + 2);
      EXPECT_GT(refused[static_cast<std::size_t>(Refusal::kHandLoaded)], 0);
    }
  }
}

// Direct mode has no arms, and the object stops when simulated time stops.
TEST(Reset, InDirectModeWaitsForTheHandsAlone) {
  Emulator emulator(LoadTestScenario("box_9kg", {"mode=direct"}));
  while (emulator.run_time() < 3) emulator.Tick(), AutoStart(&emulator);
  emulator.Request(RunEvent::kStopRequested);
  int ticks = 0;
  for (; ticks < 3000 && emulator.state() != RunState::kIdle; ++ticks) {
    if (emulator.state() == RunState::kHeld) emulator.Request(RunEvent::kReset);
    emulator.Tick();
  }
  EXPECT_EQ(emulator.state(), RunState::kIdle);
  EXPECT_GT(ticks, 2);
}

// The program must immediately refuse a start within a joint's security distance and name the place
// in the scenario.
TEST(Start, WithAJointWithinItsSecurityDistanceIsRefusedAtOnce) {
  const std::vector<std::string> set = {"rendering.joint_security=1",
                                        "rendering.joint_influence=1.1"};
  Emulator emulator(LoadTestScenario("box_9kg", set));
  int ticks = 0;
  EXPECT_EQ(Simulate(&emulator, 5, [&](const TickRecord&) { ++ticks; }), RunEnd::kNotStarted);
  EXPECT_EQ(static_cast<Refusal>(emulator.record().why_refused), Refusal::kBeyondJoint);
  EXPECT_EQ(emulator.state(), RunState::kIdle);
  EXPECT_LT(ticks, 1000);
  const std::string why = emulator.WhyNotAligned();
  EXPECT_NE(why.find("box_9kg.yaml:"), std::string::npos) << why;
  EXPECT_NE(why.find("device.arms.left.posture: the arm starts with joint \"panda_joint"),
            std::string::npos)
      << why;
  EXPECT_NE(why.find("Choose another posture, or move device.arms.left.base"), std::string::npos)
      << why;
}

TEST(Start, WithLinksTooNearIsRefusedAtOnce) {
  Emulator emulator(LoadTestScenario(
      "box_9kg", {"rendering.security_distance=0.7", "rendering.influence_distance=0.8"}));
  int ticks = 0;
  EXPECT_EQ(Simulate(&emulator, 5, [&](const TickRecord&) { ++ticks; }), RunEnd::kNotStarted);
  EXPECT_EQ(static_cast<Refusal>(emulator.record().why_refused), Refusal::kBeyondLinks);
  EXPECT_LT(ticks, 1000);
  const std::string why = emulator.WhyNotAligned();
  EXPECT_NE(why.find("device.arms.right.base: the arms start with link \"panda_link4\" of the left "
                     "arm only 0."),
            std::string::npos)
      << why;
  EXPECT_NE(why.find("rendering.security_distance is 0.700 m"), std::string::npos) << why;
}

// RECOVERY moves the joint away from its limit. After that, the program must accept a request for
// ALIGN.
TEST(Start, WithAJointWithinItsSecurityDistanceIsPossibleAfterRecovery) {
  Emulator emulator(LoadTestScenario(
      "box_9kg", {"rendering.joint_security=0.8", "rendering.joint_influence=0.9"}));
  while (emulator.state() != RunState::kIdle) emulator.Tick();
  emulator.Request(RunEvent::kAlignRequested);
  emulator.Tick();
  ASSERT_EQ(static_cast<Refusal>(emulator.record().why_refused), Refusal::kBeyondJoint);
  emulator.Request(RunEvent::kRecoverRequested);
  emulator.Tick();
  ASSERT_EQ(emulator.state(), RunState::kRecovery);
  for (int k = 0; k < 60'000 && emulator.state() == RunState::kRecovery; ++k) emulator.Tick();
  ASSERT_EQ(emulator.state(), RunState::kIdle);
  emulator.Request(RunEvent::kAlignRequested);
  emulator.Tick();
  EXPECT_EQ(emulator.record().refused, 0);
  EXPECT_EQ(emulator.state(), RunState::kAlign);
}

// A simulated sensor reports that its range is exceeded. The simulation must not use the reading.
TEST(Stop, ASimulatedSensorBeyondItsRangeMovesNothing) {
  std::vector<TickRecord> records;
  Emulator emulator(LoadTestScenario("push", {"device.arms.left.sensor.range_force=20",
                                              "device.arms.right.sensor.range_force=20"}));
  const RunEnd end =
      Simulate(&emulator, 30, [&](const TickRecord& record) { records.push_back(record); });
  ASSERT_EQ(end, RunEnd::kStopped);
  EXPECT_EQ(emulator.record().cause, StopCause::kSensor);
  std::size_t k = 0;
  while (records[k].cause == StopCause::kNone) ++k;
  EXPECT_TRUE(records[k].hands[0].sensor_saturated || records[k].hands[1].sensor_saturated);
  EXPECT_EQ(Force(records[k].hands[static_cast<std::size_t>(records[k].cause_hand)]), 0);
  ASSERT_LT(k + 1, records.size());
  EXPECT_EQ(records[k].object.twist, records[k + 1].object.twist);
  EXPECT_EQ(emulator.state(), RunState::kUnpowered);
}

// A request at the wrong time must have no effect or cause a bounded stop that ends at rest.
TEST(Stop, UntimelyRequestsEndInABoundedStop) {
  for (const RunEvent event :
       {RunEvent::kAlignRequested, RunEvent::kStartRequested, RunEvent::kReset,
        RunEvent::kStopAndPowerOff, RunEvent::kStopRequested}) {
    for (const bool while_aligning : {true, false}) {
      Emulator emulator(LoadTestScenario("box_9kg"));
      while (emulator.state() != (while_aligning ? RunState::kAlign : RunState::kRun) ||
             (!while_aligning && emulator.run_time() < 2.5)) {
        emulator.Tick();
        AutoStart(&emulator);
      }
      std::array<double, 7> last{};
      for (std::size_t j = 0; j < 7; ++j) last[j] = emulator.record().hands[0].command[j];
      emulator.Request(event);
      for (int k = 0; k < 1000; ++k) {
        emulator.Tick();
        for (std::size_t j = 0; j < 7; ++j) {
          const double v = emulator.record().hands[0].command[j];
          ASSERT_LE(std::abs(v - last[j]), 10 * 0.001 + 1e-9);  // acceleration limit of the joints
          last[j] = v;
        }
      }
      const RunState end = emulator.state();
      EXPECT_TRUE(end == RunState::kHeld || end == RunState::kUnpowered ||
                  emulator.record().cause == StopCause::kNone)
          << Name(end);
      EXPECT_NE(end, RunState::kStopping);
    }
  }
}

// The expected results of these requests are those in docs/concepts/states.md. If several stops are
// requested, the most severe one must take effect whatever their order, and no request may be lost.
struct Asked {
  const char* name;
  std::vector<RunEvent> at_once;  // all in one tick of RUN
  std::vector<RunEvent> later;    // during STOPPING
  std::vector<RunEvent> held;     // at rest
  RunState end;
};

TEST(Stop, TheMoreSevereWinsWheneverRequested) {
  const auto stop = RunEvent::kStopRequested, off = RunEvent::kStopAndPowerOff;
  for (const Asked& asked : {Asked{"stop", {stop}, {}, {}, RunState::kHeld},
                             Asked{"power off", {off}, {}, {}, RunState::kUnpowered},
                             Asked{"both", {stop, off}, {}, {}, RunState::kUnpowered},
                             Asked{"off after stop", {stop}, {off}, {}, RunState::kUnpowered},
                             Asked{"stop after off", {off}, {stop}, {stop}, RunState::kUnpowered},
                             Asked{"off when held", {stop}, {}, {off}, RunState::kUnpowered}}) {
    Emulator emulator(LoadTestScenario("box_9kg"));
    Simulate(&emulator, 2, [](const TickRecord&) {});
    const auto ask = [&](const std::vector<RunEvent>& events) {
      for (const RunEvent event : events) emulator.Request(event);
      emulator.Tick();
    };
    ask(asked.at_once);
    ASSERT_EQ(emulator.state(), RunState::kStopping) << asked.name;
    ask(asked.later);
    for (int k = 0; k < 2000 && emulator.state() == RunState::kStopping; ++k) emulator.Tick();
    ask(asked.held);
    for (int k = 0; k < 10; ++k) emulator.Tick();
    EXPECT_EQ(emulator.state(), asked.end) << asked.name;
    EXPECT_EQ(emulator.record().cause, StopCause::kOperator) << asked.name;
    EXPECT_EQ(emulator.stop().status.cause, StopCause::kOperator) << asked.name;
  }
}

TEST(Stop, BeforeTheFirstTickIsNotLost) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  emulator.Request(RunEvent::kStopRequested);
  for (int k = 0; k < 3000; ++k) {
    emulator.Tick();
    AutoStart(&emulator);
    ASSERT_NE(emulator.state(), RunState::kRun);
  }
  EXPECT_EQ(emulator.state(), RunState::kUnpowered);
  EXPECT_EQ(emulator.record().cause, StopCause::kOperator);
}

// A stop request during the normal end of a run must still become the cause.
TEST(Stop, DuringTheEndOfARunIsReported) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Simulate(&emulator, 2, [](const TickRecord&) {});
  emulator.RequestEnd();
  emulator.Tick();
  ASSERT_EQ(emulator.state(), RunState::kStopping);
  EXPECT_EQ(emulator.record().cause, StopCause::kNone);
  emulator.Request(RunEvent::kStopRequested);
  for (int k = 0; k < 2000 && emulator.state() != RunState::kHeld; ++k) emulator.Tick();
  EXPECT_EQ(emulator.record().cause, StopCause::kOperator);
  EXPECT_EQ(emulator.stop().status.cause, StopCause::kOperator);
}

// The motion of the handles during a stop, computed from the commands. Acceleration and jerk are
// within their limits from the tick after the decision on. In the tick of the decision, the stop
// continues the acceleration along the path, but the acceleration across the path ends immediately
// (docs/developer/decisions.md). The tick of the decision may therefore exceed the jerk limit, but
// not the acceleration of the run itself.
struct Ending {
  const char* scenario;
  std::vector<std::string> set;
  double stop_at;  // time of the stop request [s]; 0: none
};

TEST(Stop, KeepsToItsBoundsAtTheHandlesAndKeepsThemTogether) {
  for (const Ending& ending : {Ending{"push", {}, 0}, Ending{"underdamped", {}, 0},
                               Ending{"underdamped", {"safety.oscillation.enabled=false"}, 0},
                               Ending{"box_9kg", {}, 7}, Ending{"bar_circle", {}, 9}}) {
    const Scenario scenario = LoadTestScenario(ending.scenario, ending.set);
    Emulator emulator(scenario);
    const auto model = LoadArm(scenario, 0);
    const FrameId handle =
        model->Frame(scenario.arm(0).end_effector, scenario.arm(0).handle.ToPose());
    RobotData data(*model);
    std::array<Vector3, 2> before = {Vector3::Zero(), Vector3::Zero()};  // velocity of the handle
    double acceleration_before = 0, relative_before = 0, relative = 0;
    int stopping = 0;
    StopLog stops(scenario);
    for (int k = 0; k < 60'000 && emulator.state() != RunState::kHeld; ++k) {
      if (ending.stop_at > 0 && std::abs(emulator.run_time() - ending.stop_at) < 5e-4)
        emulator.Request(RunEvent::kStopRequested);
      emulator.Tick();
      AutoStart(&emulator);
      const TickRecord& r = emulator.record();
      stops.Add(r);
      JointVector q(model->dof()), v(model->dof());
      std::copy_n(r.hands[0].q.begin(), q.size(), q.begin());
      std::copy_n(r.hands[0].command.begin(), v.size(), v.begin());
      data.UpdateKinematics(*model, q, v);
      const Vector3 now = data.FrameTwist(*model, handle).head<3>();
      const double acceleration = (now - before[0]).norm() / emulator.dt();
      const double jerk =
          (now - 2 * before[0] + before[1]).norm() / (emulator.dt() * emulator.dt());
      before = {now, before[0]};
      const auto gap = [&r] {
        return (FromRecord(r.hands[1].real.pose).p - FromRecord(r.hands[0].real.pose).p).norm();
      };
      if (r.state == RunState::kStopping && ++stopping == 1) {
        EXPECT_LE(acceleration, acceleration_before + 0.26) << ending.scenario;
        relative_before = gap();
      } else if (r.state == RunState::kStopping) {
        EXPECT_LE(acceleration, scenario.safety.stop_acceleration + 0.01) << ending.scenario;
        // The test computes the jerk at the measured joints, but the emulator plans the stop for
        // the predicted ones.
        EXPECT_LE(jerk, 1.15 * scenario.safety.stop_jerk) << ending.scenario << " " << stopping;
        relative = std::max(relative, std::abs(gap() - relative_before));
      }
      acceleration_before = acceleration;
    }
    ASSERT_GT(stopping, 10);
    RecordProperty(ending.scenario, std::to_string(1e3 * relative) + " mm");
    // In 24 stops of `underdamped` by force, with different seeds and sides, the error was at most
    // 1.3 % of the distance.
    EXPECT_LE(relative, 0.1e-3 + 0.015 * stops.stops().back().distance) << ending.scenario;
  }
}

TEST(Stop, TakesNoLongerWhereRenderingWeighsTurningMore) {
  const Scenario scenario = LoadTestScenario(
      "box_9kg", {"rendering.characteristic_length=10",
                  "operator.script=[{action: grip, start: 0, duration: 0.5}, {action: rotate, "
                  "start: 1, duration: 2, rotate_by: [0, 0, 0.6]}]"});
  Emulator emulator(scenario);
  double turning = 0;
  for (int k = 0; k < 60'000 && emulator.state() != RunState::kHeld; ++k) {
    if (emulator.run_time() > 2) emulator.Request(RunEvent::kStopRequested);
    emulator.Tick();
    AutoStart(&emulator);
    const auto& V = emulator.record().hands[0].real.twist;
    if (emulator.state() == RunState::kRun) turning = Vector3(V[3], V[4], V[5]).norm();
  }
  const SafetySpec& safety = scenario.safety;
  const double budget =
      WorstStop(safety.handle_speed, safety.stop_acceleration, safety.stop_jerk).time;
  EXPECT_GT(turning, 0.5);
  EXPECT_LT(emulator.stop().duration, budget + StopController::kMaxFollowing);
}

TEST(Bias, OfAnyRealSizeIsTaredNotStopped) {
  const TestRun run = RunScenario("box_9kg", {"duration=2", "rig.sensor_bias=[40, 0, 0, 0, 0, 0]"});
  EXPECT_EQ(run.end, RunEnd::kFinished);
}

TEST(BadLists, AreRefusedBeforeAnythingMoves) {
  for (const char* set :
       {"device.arms.left.velocity_limit=[1, 1]", "device.arms.left.acceleration_limit=[1, 1]",
        "device.arms.right.posture=[0, 0]", "cobot.posture=[0]", "cobot.effort_limit=[1, 2]",
        "cobot.joint_friction.viscous=[1, 2]"})
    EXPECT_THROW(Emulator(LoadTestScenario("box_9kg", {set})), InputError) << set;
}

TEST(Stop, AnyClientMayRequestIt) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Simulate(&emulator, 2.0, [](const TickRecord&) {});
  ASSERT_EQ(emulator.state(), RunState::kRun);
  emulator.Request(RunEvent::kStopRequested);
  emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kStopping);
  EXPECT_EQ(emulator.record().cause, StopCause::kOperator);
}

// A run that starts in a permitted state must not cross a limit, even if the task requires it.
TEST(Limits, AreNotCrossedInClosedLoop) {
  const Scenario scenario = LoadTestScenario("box_9kg");
  for (const char* base : {"[-0.2, 0.22, -0.3]", "[0.25, 0.3, -0.1]", "[0.0, 0.05, -0.3]"}) {
    std::string mirrored = base;
    mirrored.insert(mirrored.find(", ") + 2, "-");
    double nearest = HUGE_VAL;
    RunScenario(
        "box_9kg",
        {std::string("device.arms.right.base.xyz=") + base, "device.arms.left.base.xyz=" + mirrored,
         "safety.tracking=0.5", "safety.coupling=500", "safety.coupling_torque=100",
         "safety.relative_slack=10", "safety.relative_slack_rotation=10"},
        [&](const TickRecord& record) {
          if (record.state != RunState::kRun) return;
          nearest = std::min(nearest, record.link_distance);
          EXPECT_NE(record.cause, StopCause::kJoint);
        });
    EXPECT_GE(nearest, scenario.rendering.security_distance - 1e-3) << base;
  }
}

}  // namespace
}  // namespace predictor
