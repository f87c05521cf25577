// Tests one arm's share of a stop. Each arm must never move faster or brake harder than the profile
// allows, whatever the other arm does.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "safety/stop.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor {
namespace {

constexpr double kAcceleration = 5, kJerk = 250;

// Returns the speeds [m/s] of an arm's share of a stop. In each tick, the requested speed is higher
// by `behind`.
template <class Behind>
std::vector<double> Speeds(double speed, double rate, double hold, const Behind& behind) {
  StopProfile profile(kAcceleration, kJerk, kDt, 1);
  profile.Begin(speed, rate);
  ArmBrake share(profile, hold, kDt);
  std::vector<double> v = {speed};
  for (int k = 0; k < 3000 && !share.done(); ++k) {
    const double common = profile.Next();
    v.push_back(speed * share.Next(common, profile.rate_now(), behind(k)));
  }
  return v;
}

TEST(ArmBrake, IsTheCommonProfileUnlessSomethingIsBehind) {
  for (const double speed : {1e-4, 0.01, 0.05, 0.25, 0.5}) {
    StopProfile profile(kAcceleration, kJerk, kDt, 1);
    profile.Begin(speed, -0.5);
    const auto v = Speeds(speed, -0.5, 0, [](int) { return 0.0; });
    for (std::size_t k = 1; k < v.size(); ++k) EXPECT_EQ(v[k], speed * profile.Next());
    EXPECT_TRUE(profile.done());
  }
}

TEST(ArmBrake, HoldsForAsLongAsItAnswersSooner) {
  const auto at_once = Speeds(0.25, 0, 0, [](int) { return 0.0; });
  const auto held = Speeds(0.25, 0, 0.017, [](int) { return 0.0; });
  ASSERT_EQ(held.size(), at_once.size() + 17);
  for (std::size_t k = 0; k <= 17; ++k) EXPECT_NEAR(held[k], 0.25, 1e-12) << k;
  for (std::size_t k = 0; k < at_once.size(); ++k) EXPECT_NEAR(held[k + 17], at_once[k], 2e-4) << k;
}

TEST(ArmBrake, KeepsItsBoundsWhateverItFollowsSoak) {
  for (long seed = 1; seed <= Count(2000, 100'000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "share");
    const double speed = 0.25 * random.Uniform() + 1e-3;
    const double lowest = -std::min(kAcceleration, std::sqrt(2 * kJerk * speed));
    const double rate = lowest * random.Uniform();
    const double hold = random.Uniform() < 0.5 ? 0 : 0.02 * random.Uniform();
    double behind = 0;
    const auto v = Speeds(speed, rate, hold, [&](int k) {
      if (k > 300) return 0.0;
      if (random.Uniform() < 0.1) behind = random.Uniform() < 0.5 ? 0 : random.Uniform();
      return behind;
    });
    double before = rate;
    for (std::size_t k = 1; k < v.size(); ++k) {
      const double now = (v[k] - v[k - 1]) / kDt;
      ASSERT_LE(v[k], v[k - 1] + 1e-12) << "seed " << seed << ", tick " << k;
      ASSERT_GE(now, -kAcceleration - 1e-9) << "seed " << seed << ", tick " << k;
      ASSERT_LE(std::abs(now - before), kJerk * kDt * 1.5 + 1e-9) << "seed " << seed << ", " << k;
      before = now;
    }
    EXPECT_EQ(v.back(), 0) << "seed " << seed;
    EXPECT_LT(v.size(), 600U) << "seed " << seed;
  }
}

std::array<JointBounds, kHands> BoundsOfSix() {
  std::array<JointBounds, kHands> bounds;
  for (JointBounds& b : bounds) {
    b.lower = JointVector::Constant(6, -3);
    b.upper = JointVector::Constant(6, 3);
    b.velocity = JointVector::Constant(6, 2);
    b.acceleration = JointVector::Constant(6, 10);
  }
  return bounds;
}

// Returns joints whose positions are the handles' coordinates.
StopGeometry Straight() {
  StopGeometry geometry;
  for (std::size_t i = 0; i < kHands; ++i) {
    geometry.J[i] = Jacobian::Zero(6, 6);
    for (int j = 0; j < 6; ++j) geometry.J[i](j, j) = 1;
    geometry.p_WH[i].setZero();
  }
  geometry.measured = true;
  return geometry;
}

// If the other arm does not brake at all, this arm must follow it only for the allowed time.
TEST(StopController, FollowsAnArmThatDoesNotStopForAWhileOnly) {
  const std::array<JointBounds, kHands> bounds = BoundsOfSix();
  for (const double lag : {0.006, 0.022}) {
    StopController stop(SafetySpec{}, bounds, kDt, {lag, lag});
    const double speed = 0.2;
    Twist V = Twist::Zero();
    V[0] = speed;
    const std::array<Twist, kHands> twists = {V, V};
    JointVector command = JointVector::Zero(6);
    command[0] = speed;  // a joint with a lever arm of 1 m
    stop.Begin({StopCause::kOperator}, 0, {command, command}, speed, 0, &twists);
    StopGeometry geometry = Straight();
    geometry.V_W = {V, V};
    double alone = 0, way = 0;
    StopProfile profile(5, 250, kDt, 0.25);
    profile.Begin(speed, 0);
    for (int k = 0; k < 1000; ++k) {
      std::array<JointVector, kHands> v;
      stop.Next(geometry, &v);
      // The left arm does not brake.
      geometry.V_W[1][0] += (v[1][0] - geometry.V_W[1][0]) * kDt / lag;
      alone += speed * profile.Next() * kDt;
      way += v[1][0] * kDt;
    }
    EXPECT_TRUE(stop.commands_rest());
    EXPECT_GT(way, alone + 0.001) << lag;
    EXPECT_LT(way, alone + speed * (StopController::kMaxFollowing + 0.02)) << lag;
  }
}

// Stops two arms and returns the distance between them at rest [m]. The first arm coasts, because
// it follows its commands with a lag. The second arm reaches the position to which its commands
// lead, but with a lag of `lag` [s] and a delay of `late` [ms]. `hindered` is an additional delay
// of the first arm that it does not report [ms].
double ApartAtRest(const std::array<double, kHands>& coasting, std::size_t late, double lag = 0.006,
                   std::size_t hindered = 0) {
  constexpr double kSpeed = 0.2, kGain = 15;
  const std::array<double, kHands> lags = {0.022, lag};
  StopController stop(SafetySpec{}, BoundsOfSix(), kDt, lags, coasting);
  Twist V = Twist::Zero();
  V[0] = kSpeed;
  const std::array<Twist, kHands> twists = {V, V};
  JointVector command = JointVector::Zero(6);
  command[0] = kSpeed;
  stop.Begin({StopCause::kOperator}, 0, {command, command}, kSpeed, 0, &twists);
  StopGeometry geometry = Straight();
  geometry.V_W = twists;
  std::vector<double> reported(late, kSpeed), first_reported(hindered, kSpeed);
  double first = 0, second = 0, wanted = 0;
  for (std::size_t k = 0; k < 1500; ++k) {
    std::array<JointVector, kHands> v;
    stop.Next(geometry, &v);
    first_reported.push_back(v[0][0]);
    reported.push_back(v[1][0]);
    wanted += v[1][0] * kDt;
    const std::array<double, kHands> to = {first_reported[k],
                                           reported[k] + (k > 150 ? kGain * (wanted - second) : 0)};
    for (std::size_t i = 0; i < kHands; ++i)
      geometry.V_W[i][0] += (to[i] - geometry.V_W[i][0]) * kDt / lags[i];
    first += geometry.V_W[0][0] * kDt;
    second += geometry.V_W[1][0] * kDt;
  }
  EXPECT_TRUE(stop.commands_rest());
  return std::abs(first - second);
}

TEST(StopController, WaitsForAnArmsLagButDoesNotChaseItsReturn) {
  for (const std::size_t late : {0, 10}) {
    EXPECT_LT(ApartAtRest({0.022, 0.001}, late), 1e-3) << late;
    EXPECT_GT(ApartAtRest({0.022, 0.006}, late), 1.3e-3) << late;
  }
}

// If an arm is represented by its commands, its lag is not measured, so it may follow as hard as a
// quick arm.
TEST(StopController, AnArmJudgedByItsCommandsFollowsWithAnyLag) {
  for (const double lag : {0.006, 0.012, 0.022})
    EXPECT_LT(ApartAtRest({0.022, 0.001}, 0, lag, 10), 1e-3) << lag;
}

}  // namespace
}  // namespace predictor
