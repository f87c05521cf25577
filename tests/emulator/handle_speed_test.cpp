// No handle may exceed the speed limit of the current state, even if the arms are far from their
// goal or a person pushes hard. real_arms_recovery_test.cpp covers RECOVERY.
#include <gtest/gtest.h>

#include "devices/simulated/simulated_device.h"
#include "handle_speeds.h"
#include "runs.h"

namespace predictor {
namespace {

constexpr double kOvershoot = 1.05;     // overshoot of the arms' velocity loops above a limit
constexpr double kPosture = 1.03;       // change of an arm's Jacobian until it follows
constexpr double kAlignRotation = 0.3;  // [rad/s]

// Returns start joints in which the distance between the handles is wrong by half a metre. The
// handles' relative rotation is right, wrong by half a turn, or wrong by even more. In the last
// case, the shortest rotation from one handle to the other leads away from the goal.
enum class Turned { kNone, kHalf, kFurther };
std::array<JointVector, kHands> Apart(const Scenario& scenario, Turned turned) {
  const double angle = turned == Turned::kNone ? -0.7 : turned == Turned::kHalf ? 0.85 : 1.4;
  std::array<JointVector, kHands> start = Emulator(scenario).setup().start;
  for (std::size_t i = 0; i < kHands; ++i) {
    start[i][0] += i == 0 ? -0.7 : 0.7;
    start[i][6] += (i == 0 ? 1 : -1) * angle;
  }
  return start;
}

double FarFromOneAnother(const TickRecord& record, double* angle) {
  const auto pose = [&](std::size_t i) { return FromRecord(record.hands[i].real.pose); };
  const auto goal = [&](std::size_t i) { return FromRecord(record.hands[i].virtual_.pose); };
  const Pose real = pose(0).Inverse() * pose(1), wanted = goal(0).Inverse() * goal(1);
  *angle = RotationError(wanted.q, real.q).norm();
  return (wanted.p - real.p).norm();
}

struct Aligning {
  double distance = 0, angle = 0;  // initial error of the relative pose [m], [rad]
  Speeds reported, came;
  bool armed = false;
};

Aligning Align(const Scenario& scenario, Turned turned) {
  auto device = std::make_unique<SimulatedDevice>(scenario, Apart(scenario, turned),
                                                  MakeOperator(scenario, HandInertia::kInWrench));
  const Rig& rig = device->rig();
  HandleSpeeds handles(scenario);
  Emulator emulator(scenario, std::move(device));
  Aligning seen;
  for (int k = 0; k < 25'000 && !seen.armed; ++k) {
    if (emulator.state() == RunState::kIdle) emulator.Request(RunEvent::kAlignRequested);
    emulator.Tick();
    const TickRecord& record = emulator.record();
    EXPECT_NE(record.state, RunState::kStopping) << Name(record.cause);
    seen.armed = record.state == RunState::kArmed;
    if (record.state != RunState::kAlign) continue;
    if (seen.distance == 0) seen.distance = FarFromOneAnother(record, &seen.angle);
    seen.reported.See(handles.Commanded(record));
    for (const FrameMotion& handle : rig.true_handles()) seen.came.See(handle.V_W);
  }
  return seen;
}

TEST(HandleSpeed, OfAlignIsKeptForAnyErrorOfTheArmsRelativePose) {
  for (const char* gain : {"1", "1000"})
    for (const Turned turned : {Turned::kNone, Turned::kHalf, Turned::kFurther}) {
      const std::string value = gain;
      SCOPED_TRACE(value + ", turned " + std::to_string(static_cast<int>(turned)));
      const Scenario scenario = LoadTestScenario(
          "box_9kg", {"rendering.relative_kp=" + value, "rendering.relative_ko=" + value});
      const Aligning seen = Align(scenario, turned);
      EXPECT_GT(seen.distance, 0.45);
      if (turned == Turned::kHalf) {
        EXPECT_GT(seen.angle, 2.8);
      }
      const double cap = scenario.safety.align_speed;
      EXPECT_GT(std::max(seen.reported.translation / cap, seen.reported.rotation / kAlignRotation),
                0.95);
      EXPECT_LE(seen.reported.translation, kPosture * cap);
      EXPECT_LE(seen.reported.rotation, kPosture * kAlignRotation);
      EXPECT_LE(seen.came.translation, kOvershoot * cap);
      EXPECT_LE(seen.came.rotation, kOvershoot * kAlignRotation);
      // If the gain is too high, the relative pose oscillates because of the arms' lag. This
      // oscillation does not matter in this test.
      EXPECT_TRUE(seen.armed);
    }
}

TEST(HandleSpeed, OfARunIsKeptHoweverHardThePush) {
  const std::vector<std::string> set = {"duration=10",
                                        "safety.force=900",
                                        "safety.torque=99",
                                        "safety.tracking=9",
                                        "safety.coupling=9000",
                                        "safety.coupling_torque=9000",
                                        "safety.relative_slack=9",
                                        "safety.relative_slack_rotation=99",
                                        "safety.tracking_rotation=3.1",
                                        "coupling.speed_damping=0",
                                        "safety.oscillation.amplitude=900",
                                        "rendering.relative_kp=50"};
  const Scenario scenario = LoadTestScenario("push", set);
  HandleSpeeds handles(scenario);
  Speeds reported, measured, virtual_;
  RunScenario("push", set, [&](const TickRecord& record) {
    if (record.state != RunState::kRun) return;
    reported.See(handles.Commanded(record));
    for (const HandRecord& hand : record.hands) {
      measured.See(Eigen::Map<const Vector6>(hand.real.twist.data()));
      virtual_.See(Eigen::Map<const Vector6>(hand.virtual_.twist.data()));
    }
  });
  const double cap = scenario.safety.handle_speed;
  EXPECT_GT(virtual_.translation, 1.5 * cap);  // proves that the push is hard
  EXPECT_GT(reported.translation, 0.99 * cap);
  EXPECT_LE(reported.translation, kPosture * cap);
  EXPECT_LE(reported.rotation, kPosture * scenario.safety.handle_rotation_speed);
  // tolerance for the noise of the joint velocities
  EXPECT_LE(measured.translation, kOvershoot * cap + 0.002);
}

}  // namespace
}  // namespace predictor
