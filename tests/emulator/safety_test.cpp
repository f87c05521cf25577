// The paper's Fig. 9 and its counterparts: what stops a run, when, and how the arms come to rest.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "core/error.h"
#include "runs.h"
#include "support/soak.h"

namespace predictor {
namespace {

double Force(const HandRecord& hand) {
  return Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]).norm();
}

TEST(Stop, APushEndsByForceInTheTickInWhichItIsSeen) {
  std::optional<TickRecord> decision;
  double before = 0;  // largest estimated force in any earlier tick
  const TestRun run = RunScenario("push", {}, [&](const TickRecord& record) {
    if (record.cause != StopCause::kNone) {
      if (!decision) decision = record;
      return;
    }
    for (const HandRecord& hand : record.hands) before = std::max(before, Force(hand));
  });
  ASSERT_EQ(run.end, RunEnd::kStopped);
  EXPECT_EQ(run.summary.stop->cause, StopCause::kForce);
  ASSERT_TRUE(decision);
  EXPECT_LE(before, 30);
  EXPECT_GT(Force(decision->hands[static_cast<std::size_t>(decision->cause_hand)]), 30);
  EXPECT_EQ(decision->state, RunState::kStopping);
  ASSERT_TRUE(run.summary.stop->detection);
  EXPECT_LE(*run.summary.stop->detection, 0.010);  // sensor's low-pass and delay
}

TEST(Stop, AnUnderdampedCobotEndsByOscillationOrElseByForce) {
  EXPECT_EQ(RunScenario("underdamped").summary.stop->cause, StopCause::kOscillation);
  const TestRun unwatched = RunScenario("underdamped", {"safety.oscillation.enabled=false"});
  ASSERT_TRUE(unwatched.summary.stop);
  EXPECT_EQ(unwatched.summary.stop->cause, StopCause::kForce);
}

TEST(Stop, TheSameScriptPassesWithDamping) {
  const TestRun run = RunScenario("underdamped", {"cobot.controller.damping_ratio=0.7"});
  EXPECT_EQ(run.end, RunEnd::kFinished);
}

// Circle, transports and release raise no alarm, whatever the hand's noise and pace.
TEST(Stop, NormalWorkRaisesNoAlarmSoak) {
  for (long seed = 1; seed <= Count(3, 50); ++seed)
    for (const char* name : {"box_9kg", "box_18kg", "bar_circle", "dual_ur5"}) {
      const TestRun run = RunScenario(name, {"seed=" + std::to_string(seed)});
      EXPECT_EQ(run.end, RunEnd::kFinished)
          << name << ", seed " << seed << ": " << Name(run.stop.status.cause) << " at "
          << run.stop.time << " s";
    }
}

// box_9kg with a script of moves to and fro along y, each further than the last by 2 cm.
std::vector<std::string> ToAndFro(double duration) {
  const auto number = [](double x) { return std::to_string(x); };
  std::string script = "[{action: grip, start: 0, duration: 0.5}";
  double at = 1;
  for (int k = 1; k <= 5; ++k, at += 1.1 * duration)
    script += ", {action: move, start: " + number(at) + ", duration: " + number(duration) +
              ", by: [0, " + number((k % 2 ? 0.02 : -0.02) * k) + ", 0]}";
  return {"operator.script=" + script + "]", "duration=" + number(at)};
}

// What a script asks for is told from an oscillation by being slower (docs/decisions.md): beyond
// the band nothing counts, however it grows. Inside it, to and fro at 0.5 Hz with growing force is
// what the monitor is there to stop, whoever causes it.
TEST(Stop, AScriptsOwnMotionIsNoOscillationUnlessItIsAsFastAsOne) {
  EXPECT_EQ(RunScenario("box_9kg", ToAndFro(1.6)).end, RunEnd::kFinished);
  EXPECT_EQ(RunScenario("box_9kg", ToAndFro(2.5)).end, RunEnd::kFinished);
}

// Both arms come to rest by one common factor, the handles within the bounds on acceleration and
// jerk, and stay at rest.
TEST(Stop, ScalesBothArmsByOneFactor) {
  std::vector<TickRecord> records;
  RunScenario("push", {}, [&](const TickRecord& record) {
    if (record.state == RunState::kStopping || record.state == RunState::kHeld ||
        record.run_time > 8)
      records.push_back(record);
  });
  std::size_t k = 0;
  while (records[k].cause == StopCause::kNone) ++k;
  const TickRecord& last = records[k - 1];
  for (; k < records.size(); ++k) {
    double factor = -1;
    for (std::size_t i = 0; i < kHands; ++i)
      for (std::size_t j = 0; j < 7; ++j) {
        if (std::abs(last.hands[i].command[j]) < 1e-3) continue;
        const double f = records[k].hands[i].command[j] / last.hands[i].command[j];
        if (factor < 0) factor = f;
        EXPECT_NEAR(f, factor, 1e-6) << "tick " << k;
      }
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
  EXPECT_EQ(emulator.run_time(), stopped_at);  // simulated time stands still
  emulator.Request(RunEvent::kReset);
  emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kIdle);
  EXPECT_EQ(emulator.record().cause, StopCause::kNone);
  EXPECT_EQ(emulator.run_time(), 0);
}

// Whatever is asked for at the wrong time ends in a bounded stop that comes to rest, or in nothing.
TEST(Stop, UntimelyRequestsEndInABoundedStop) {
  for (const RunEvent event :
       {RunEvent::kAlignRequested, RunEvent::kStartRequested, RunEvent::kReset,
        RunEvent::kStopAndPowerOff, RunEvent::kStopRequested}) {
    for (const bool while_aligning : {true, false}) {
      Emulator emulator(LoadTestScenario("box_9kg"));
      while (emulator.state() != (while_aligning ? RunState::kAlign : RunState::kRun) ||
             (!while_aligning && emulator.run_time() < 2.5)) {
        emulator.Tick();
        StartByItself(&emulator);
      }
      std::array<double, 7> last{};
      for (std::size_t j = 0; j < 7; ++j) last[j] = emulator.record().hands[0].command[j];
      emulator.Request(event);
      for (int k = 0; k < 1000; ++k) {
        emulator.Tick();
        for (std::size_t j = 0; j < 7; ++j) {
          const double v = emulator.record().hands[0].command[j];
          ASSERT_LE(std::abs(v - last[j]), 10 * 0.001 + 1e-9);  // the joints' acceleration
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

TEST(Stop, AnybodyMayAskForIt) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Simulate(&emulator, 2.0, [](const TickRecord&) {});
  ASSERT_EQ(emulator.state(), RunState::kRun);
  emulator.Request(RunEvent::kStopRequested);
  emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kStopping);
  EXPECT_EQ(emulator.record().cause, StopCause::kOperator);
}

// From a legal state no limit is crossed, also where the task asks for it.
TEST(Limits, AreNotCrossedInClosedLoop) {
  const Scenario scenario = LoadTestScenario("box_9kg");
  for (const char* base : {"[-0.2, 0.22, -0.3]", "[0.25, 0.3, -0.1]", "[0.0, 0.05, -0.3]"}) {
    std::string mirrored = base;
    mirrored.insert(mirrored.find(", ") + 2, "-");
    double nearest = HUGE_VAL;
    RunScenario(
        "box_9kg",
        {std::string("device.arms.left.base.xyz=") + base, "device.arms.right.base.xyz=" + mirrored,
         "safety.tracking=0.5", "safety.coupling=500", "safety.coupling_torque=100",
         "safety.relative_slack=10", "safety.relative_slack_rotation=10"},
        [&](const TickRecord& record) {
          if (record.state != RunState::kRun) return;
          nearest = std::min(nearest, record.elbow_distance);
          EXPECT_NE(record.cause, StopCause::kJoint);
        });
    EXPECT_GE(nearest, scenario.rendering.security_distance - 1e-3) << base;
  }
}

}  // namespace
}  // namespace predictor
