// Tests the predicted time and distance of a stop, including the arms' lag.
#include "emulator/stop_reach.h"

#include <gtest/gtest.h>

#include <functional>

#include "runs.h"
#include "safety/stop.h"

namespace predictor {
namespace {

// The promised maximum of the time for which one arm continues because of the other [s]. It is a
// number of its own, so that a longer time in StopController does not pass these tests.
constexpr double kFollowing = 0.030;

StopBudget Of(const std::function<void(ArmSpec*)>& left,
              const std::function<void(ArmSpec*)>& right) {
  Scenario s = LoadTestScenario("box_9kg");
  s.safety.handle_speed = 0.25;
  s.device.left->loop = s.device.right->loop = {200, 0.9, 0};
  left(&*s.device.left);
  right(&*s.device.right);
  return StopOfArms(s);
}
StopBudget OfBoth(const std::function<void(ArmSpec*)>& change) { return Of(change, change); }

void Slow(ArmSpec* arm) { arm->loop = {15, 0.9, 0.004}; }
void Quick(ArmSpec*) {}
void Follows(ArmSpec* arm) {
  Slow(arm);
  arm->follows_position = true;
}

// If the lag is insignificant, the stop consists of the commanded profile and the time for which
// one arm follows the other.
TEST(StopOfArms, IsTheBudgetForArmsWithoutLag) {
  const StopBudget commanded = WorstStop(0.25, 5, 250), stop = OfBoth(Quick);
  EXPECT_NEAR(stop.time, commanded.time + kFollowing, 0.006);
  EXPECT_NEAR(stop.way, commanded.way + 0.25 * kFollowing, 0.0006);
}

TEST(StopOfArms, HasTheArmsLagInIt) {
  const StopBudget quick = OfBoth(Quick), slow = OfBoth(Slow);
  const double lag = 0.004 + 2 * 0.9 / (2 * 3.14159265 * 15);
  // Handles that accelerate lag less than handles at constant speed.
  EXPECT_LT(slow.way, quick.way + 0.25 * lag);
  EXPECT_GT(slow.way, quick.way + 0.4 * 0.25 * lag);
  EXPECT_GT(slow.time, quick.time + lag);
  EXPECT_LT(slow.time, quick.time + 2 * lag);
  const StopBudget later = OfBoth([](ArmSpec* arm) { arm->loop = {15, 0.9, 0.014}; });
  EXPECT_NEAR(later.time, slow.time + 0.010, 0.0015);
  EXPECT_LT(later.way, slow.way + 0.25 * 0.010);
  EXPECT_GT(later.way, slow.way + 0.0003);
}

// Position control lets the arm overshoot and then pulls it back, so the stop takes longer.
TEST(StopOfArms, TakesAnArmThatFollowsAPositionLonger) {
  const StopBudget slow = OfBoth(Slow), follows = OfBoth(Follows);
  EXPECT_NEAR(follows.time, 0.200 + kFollowing, 0.004);
  EXPECT_NEAR(follows.way, 0.0238 + 0.25 * kFollowing, 0.0004);
  EXPECT_GT(follows.time, slow.time + 0.05);
}

// The arm with the smaller overrun must wait for the other one.
TEST(StopOfArms, IsOfTheSlowerArmAndTheOneThatWaits) {
  const StopBudget mixed = Of(Slow, Follows), swapped = Of(Follows, Slow);
  EXPECT_EQ(mixed.time, swapped.time);
  EXPECT_EQ(mixed.way, swapped.way);
  const double waits = Overrun(LoadTestScenario("box_9kg").arm(0), 0.001) - 0.001;
  EXPECT_GT(waits, 0.015);
  EXPECT_NEAR(mixed.way, OfBoth(Follows).way + 0.25 * waits, 0.002);
  EXPECT_GT(mixed.time, OfBoth(Follows).time);
}

// Joints that move at 2 rad/s and may decelerate at three quarters of 4 rad/s² take two thirds of a
// second to stop. The handles take the same time.
TEST(StopOfArms, IsLongerWhereJointsTurnAsFastAsTheyMay) {
  Scenario s = LoadTestScenario("box_9kg");
  s.safety.handle_speed = 0.25;
  for (std::optional<ArmSpec>* arm : {&s.device.left, &s.device.right}) {
    (*arm)->loop = {200, 0.9, 0};
    (*arm)->velocity_limit.assign(7, 2);
    (*arm)->acceleration_limit = {4};
  }
  const double a = MinStopAcceleration(s);
  EXPECT_NEAR(a, 0.25 * 0.75 * 4 / 2, 1e-9);
  const StopBudget longest = StopOfArms(s, a);
  EXPECT_NEAR(longest.time, (0.25 - 0.005) / a + a / 250 + kFollowing, 0.01);
  EXPECT_NEAR(longest.way, 0.25 * 0.25 / (2 * a) + 0.25 * kFollowing, 0.002);
  s.device.right->acceleration_limit = {0.4};
  EXPECT_NEAR(MinStopAcceleration(s), a / 10, 1e-9);
  EXPECT_NEAR(StopOfArms(s, a / 10).time, (0.25 - 0.005) / (a / 10) + kFollowing, 0.02);
  s.device.right->acceleration_limit = s.device.left->acceleration_limit = {1000};
  EXPECT_EQ(MinStopAcceleration(s), s.safety.stop_acceleration);
}

TEST(StopOfArms, OfOneArmIsWithoutFollowing) {
  Scenario s = LoadTestScenario("single_arm");
  (s.Has(0) ? s.device.left : s.device.right)->loop = {200, 0.9, 0};
  s.safety.handle_speed = 0.25;
  EXPECT_NEAR(StopOfArms(s).time, WorstStop(0.25, 5, 250).time, 0.006);
}

}  // namespace
}  // namespace predictor
