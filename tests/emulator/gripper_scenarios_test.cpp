// Tests the scenarios in which the cobot's gripper opens and closes. The expected values are closed
// forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "runs.h"

namespace predictor {
namespace {

AttachmentState GripOf(const TickRecord& record) {
  return static_cast<AttachmentState>(record.attachment);
}

// The mean vertical force of the hands on the object [N].
struct HandsForce {
  double sum = 0;
  int ticks = 0;
  void Add(const TickRecord& record) {
    ++ticks;
    for (const HandRecord& hand : record.hands) sum += hand.true_wrench[2];
  }
  double mean() const { return sum / ticks; }
};

TEST(GripperScenarios, ABoxIsPutDownAndPickedUpAgain) {
  const FixtureSpec table = LoadTestScenario("put_down_and_pick_up").environment.fixtures[0];
  const double top = table.xyz.z() + table.size.z() / 2;  // [m]
  constexpr double kHalfHeight = 0.1;                     // of the box [m]
  HandsForce resting, lifted;
  double deepest = -HUGE_VAL, moved = 0, cobot_moved = 0, speed = 0, lift = 0;
  Pose rest, cobot;
  bool states_agree = true;
  const TestRun run = RunScenario("put_down_and_pick_up", {}, [&](const TickRecord& record) {
    const Pose X = ObjectOf(record), E = FromRecord(record.end_effector.pose);
    const double t = record.run_time;
    const bool open = t > 10.1 && t < 14.9, closed = t < 9.9 || t > 15.5;
    if (open || closed)
      states_agree = states_agree &&
                     record.attachment == static_cast<std::uint8_t>(open ? AttachmentState::kOpen
                                                                         : AttachmentState::kHolds);
    for (const double x : {-0.13, 0.13})
      for (const double y : {-0.19, 0.19})
        deepest = std::max(deepest, top - (X * Vector3(x, y, -kHalfHeight)).z());
    if (t < 10) cobot = E;
    if (open) cobot_moved = std::max(cobot_moved, (E.p - cobot.p).norm());
    if (t < 12.2) rest = X;
    if (t >= 12.2 && t < 13.4) {  // no hand holds the box
      resting.Add(record);
      moved = std::max(moved, (X.p - rest.p).norm());
    }
    if (t > 15 && t < 16.5)
      speed = std::max(speed, Vector3::Map(record.object.twist.data()).norm());
    if (t > 20.2 && t < 20.9) {
      lifted.Add(record);
      lift = X.p.z() - kHalfHeight - top;
    }
  });
  EXPECT_TRUE(EndsWell(run));
  EXPECT_TRUE(states_agree);
  EXPECT_LE(deepest, 1e-4);
  ASSERT_GT(resting.ticks, 1000);
  EXPECT_EQ(resting.mean(), 0);  // the table alone carries the box
  EXPECT_LT(moved, 1e-4);
  EXPECT_LT(cobot_moved, 5e-3);
  EXPECT_LT(speed, 5e-3);  // while the cobot grasps
  ASSERT_GT(lifted.ticks, 500);
  EXPECT_GT(lift, 0.03);
  EXPECT_NEAR(lifted.mean(), 0, 4);  // of 88 N
}

// The person pulls until the gripper opens. Then the person carries the weight of the tool.
TEST(GripperScenarios, AToolIsHandedOver) {
  const Scenario scenario = LoadTestScenario("hand_over_tool");
  const double threshold = *scenario.events[0].trigger.force;  // [N]
  constexpr double kWeight = 1.5 * 9.81;                       // of the tool [N]
  double before = 0, pull = 0, opened = 0, moved = 0;
  HandsForce holding, carrying;
  const TestRun run = RunScenario("hand_over_tool", {}, [&](const TickRecord& record) {
    const double force = Vector3::Map(record.hands[0].wrench.data()).norm();
    const double t = record.run_time;
    if (GripOf(record) == AttachmentState::kOpen && opened == 0) {
      opened = t;
      pull = force;
    }
    if (opened == 0) before = std::max(before, force);
    if (t > 1 && t < 2) holding.Add(record);  // the cobot carries the tool
    if (t > 13 && t < 15.5) {
      carrying.Add(record);
      const Vector3 to_cobot = ObjectOf(record).p - FromRecord(record.end_effector.pose).p;
      moved = to_cobot.norm();
    }
  });
  EXPECT_TRUE(EndsWell(run));
  EXPECT_GT(opened, 2);
  EXPECT_LT(opened, 8);
  EXPECT_GT(pull, threshold - 1);  // the event uses the force of the previous tick
  EXPECT_LT(before, threshold + 1);
  EXPECT_NEAR(holding.mean(), 0, 2);
  EXPECT_NEAR(carrying.mean(), kWeight, 0.05 * kWeight);
  EXPECT_GT(moved, 0.2);  // 0.175 m while the cobot held it
}

}  // namespace
}  // namespace predictor
