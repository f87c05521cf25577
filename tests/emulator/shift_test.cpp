// Tests that environment.shift moves the virtual world relative to the arms and changes nothing
// else.
#include <gtest/gtest.h>

#include "core/error.h"
#include "runs.h"

namespace predictor {
namespace {

const PoseSpec kShift = {{0.4, -0.7, 0.25}, {0, 0, 0.7}};

// Returns the scenario with the arms at the same place in W, but with W elsewhere in the rig.
Scenario Elsewhere(Scenario s, const PoseSpec& shift) {
  for (const int hand : s.hands()) {
    BaseSpec& base = (hand == 0 ? s.device.left : s.device.right)->base;
    const Pose X_RB = shift.ToPose() * base.X_RB();
    base = {X_RB.p, RpyOf(X_RB.q)};
  }
  s.environment.shift = shift;
  return s;
}

std::vector<TickRecord> RecordsOf(const Scenario& scenario) {
  Emulator emulator(scenario);
  std::vector<TickRecord> records;
  Simulate(&emulator, scenario.duration, [&](const TickRecord& r) { records.push_back(r); });
  return records;
}

void ExpectSame(const Pose& a, const Pose& b, std::uint64_t tick) {
  ASSERT_LT((a.p - b.p).norm(), 1e-9) << "tick " << tick;
  ASSERT_LT(RotationError(a.q, b.q).norm(), 1e-9) << "tick " << tick;
}

// The pose of the handle does not determine the motion of all seven joints. This free motion
// accumulates, so the joints of two runs may differ more than the handles.
constexpr double kSameJoint = 1e-7;  // [rad]

// One arm's base is tilted, so that gravity does not act along the z axis of the base. The readings
// have no quantisation steps, because the last bit may decide to which step a reading is rounded.
TEST(Shift, OfSceneAndArmsTogetherChangesNothing) {
  Scenario here = LoadTestScenario("box_9kg", {"duration=6", "rig.encoder_resolution=0"});
  for (auto* arm : {&here.device.left, &here.device.right})
    (*arm)->sensor.force_resolution = (*arm)->sensor.torque_resolution = 0;
  here.device.right->base.rpy = {0.02, -0.03, 0.1};
  const std::vector<TickRecord> a = RecordsOf(here), b = RecordsOf(Elsewhere(here, kShift));
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 6000U);
  ASSERT_EQ(a.back().cause, b.back().cause);
  for (std::size_t k = 0; k < a.size(); ++k) {
    ExpectSame(FromRecord(a[k].object.pose), FromRecord(b[k].object.pose), k);
    for (std::size_t h = 0; h < kHands; ++h) {
      const HandRecord &x = a[k].hands[h], &y = b[k].hands[h];
      ExpectSame(FromRecord(x.real.pose), FromRecord(y.real.pose), k);
      ExpectSame(FromRecord(x.virtual_.pose), FromRecord(y.virtual_.pose), k);
      for (std::size_t j = 0; j < x.arm_dof; ++j) ASSERT_NEAR(x.q[j], y.q[j], kSameJoint);
      for (std::size_t i = 0; i < 6; ++i) ASSERT_NEAR(x.wrench[i], y.wrench[i], 1e-6);
    }
  }
  if (HasFatalFailure()) FAIL();
}

// This test shows that a shift has an effect. If a shift had no effect, the previous test would
// prove nothing.
TEST(Shift, OfTheSceneAloneMovesItForTheArms) {
  const Scenario here = LoadTestScenario("box_9kg", {"duration=0.2"});
  Scenario lower = here;
  lower.environment.shift = PoseSpec{{0, 0.02, -0.03}, {0, 0, 0.05}};
  const std::vector<TickRecord> a = RecordsOf(here), b = RecordsOf(lower);
  double most = 0;
  for (std::size_t j = 0; j < a[50].hands[0].arm_dof; ++j)
    most = std::max(most, std::abs(a[50].hands[0].q[j] - b[50].hands[0].q[j]));
  EXPECT_GT(most, 0.02);
  // In the frame W, the arms hold the handles at the same poses.
  for (std::size_t h = 0; h < kHands; ++h)
    EXPECT_LT(
        (FromRecord(a[50].hands[h].real.pose).p - FromRecord(b[50].hands[h].real.pose).p).norm(),
        1e-4);
}

TEST(Shift, OutOfReachNamesTheShiftAndNotTheBase) {
  Scenario s = LoadTestScenario("box_9kg", {"environment.shift={xyz: [3, 0, 0]}"});
  try {
    Emulator emulator(s);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Change environment.shift."), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace predictor
