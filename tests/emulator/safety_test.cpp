// The paper's Fig. 9 and its counterparts: what stops a run, when, and how the arms come to rest.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "core/error.h"
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
  double before = 0;  // largest estimated force in any earlier tick
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
  EXPECT_LE(*run.summary.stops.front().detection, 0.010);  // sensor's low-pass and delay
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

// Both arms come to rest by one common factor and stay at rest.
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
      // What the arms' changing geometry takes besides is small, over a way of 2 cm.
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

// Requests through the whole emulator, as docs/states.md tells them: the more severe stop wins,
// whenever it comes, and none is lost.
struct Asked {
  const char* name;
  std::vector<RunEvent> at_once;  // in one tick of RUN
  std::vector<RunEvent> later;    // while STOPPING
  std::vector<RunEvent> held;     // once at rest
  RunState end;
};

TEST(Stop, TheMoreSevereWinsWheneverItIsAskedFor) {
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
    StartByItself(&emulator);
    ASSERT_NE(emulator.state(), RunState::kRun);
  }
  EXPECT_EQ(emulator.state(), RunState::kUnpowered);
  EXPECT_EQ(emulator.record().cause, StopCause::kOperator);
}

// What ends a run normally may still find a cause on its way to rest.
TEST(Stop, DuringTheEndOfARunIsTold) {
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

// A stop as the handles feel it, from the commands: within the bounds on acceleration and jerk from
// the tick after the decision on. In the deciding tick the motion along the path is taken over as
// it is; what acceleration there was across it ends at once (docs/decisions.md), so that tick may
// jerk, but never accelerates harder than the run itself did.
struct Ending {
  const char* scenario;
  std::vector<std::string> set;
  double stop_at;  // on request [s]; 0: by itself
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
    std::array<Vector3, 2> before = {Vector3::Zero(), Vector3::Zero()};  // handle's velocity
    double acceleration_before = 0, relative_before = 0, relative = 0;
    int stopping = 0;
    for (int k = 0; k < 60'000 && emulator.state() != RunState::kHeld; ++k) {
      if (ending.stop_at > 0 && std::abs(emulator.run_time() - ending.stop_at) < 5e-4)
        emulator.Request(RunEvent::kStopRequested);
      emulator.Tick();
      StartByItself(&emulator);
      const TickRecord& r = emulator.record();
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
        // Seen from the measured joints; the stop is planned where the command will be obeyed.
        EXPECT_LE(jerk, 1.15 * scenario.safety.stop_jerk) << ending.scenario << " " << stopping;
        relative = std::max(relative, std::abs(gap() - relative_before));
      }
      acceleration_before = acceleration;
    }
    ASSERT_GT(stopping, 10);
    RecordProperty(ending.scenario, std::to_string(1e3 * relative) + " mm");
    // Over 24 stops of `underdamped` by force, seeds and sides: at most 1.3 % of the way.
    EXPECT_LE(relative, 0.1e-3 + 0.015 * emulator.stop().distance) << ending.scenario;
  }
}

TEST(Stop, TakesNoLongerWhereRenderingWeighsTurningMore) {
  const Scenario scenario = LoadTestScenario(
      "box_9kg", {"rendering.rotation_length=10",
                  "operator.script=[{action: grip, start: 0, duration: 0.5}, {action: rotate, "
                  "start: 1, duration: 2, rotate_by: [0, 0, 0.6]}]"});
  Emulator emulator(scenario);
  double turning = 0;
  for (int k = 0; k < 60'000 && emulator.state() != RunState::kHeld; ++k) {
    if (emulator.run_time() > 2) emulator.Request(RunEvent::kStopRequested);
    emulator.Tick();
    StartByItself(&emulator);
    const auto& V = emulator.record().hands[0].real.twist;
    if (emulator.state() == RunState::kRun) turning = Vector3(V[3], V[4], V[5]).norm();
  }
  const SafetySpec& safety = scenario.safety;
  const double budget =
      WorstStop(safety.handle_speed, safety.stop_acceleration, safety.stop_jerk).time;
  EXPECT_GT(turning, 0.5);
  EXPECT_LT(emulator.stop().duration, budget + StopController::kMostFollowing);
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
        {std::string("device.arms.right.base.xyz=") + base, "device.arms.left.base.xyz=" + mirrored,
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
