#include "safety/stop_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/random.h"
#include "safety/between.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor {
namespace {

// Returns the speeds of a stop [m/s], from the first command to the final zero.
std::vector<double> Speeds(StopProfile profile, double speed, double rate) {
  profile.Begin(speed, rate);
  std::vector<double> v = {speed};
  while (!profile.done() && v.size() < 100000) v.push_back(speed * profile.Next());
  return v;
}

double Travelled(const std::vector<double>& v, double dt) {
  double sum = 0;
  for (std::size_t k = 1; k < v.size(); ++k) sum += (v[k - 1] + v[k]) / 2 * dt;
  return sum;
}

// The budget is that of the worst stop from any speed v and acceleration a under the cap, v + a²/2j
// <= cap.
struct Budget {
  double cap, time, distance, detection_travel;
};
constexpr Budget kBudgets[] = {{0.25, 0.090, 0.0134, 0.0008}, {0.5, 0.140, 0.0397, 0.0015}};

TEST(StopProfile, WorstCaseIsTheBudget) {
  for (const Budget& budget : kBudgets) {
    double time = 0, distance = 0;
    for (int i = 1; i <= 200; ++i) {
      for (int j = -10; j <= 10; ++j) {
        const double rate = 0.5 * j, gain = rate > 0 ? rate * rate / 500 : 0;
        const double speed = budget.cap * i / 200;
        if (speed + gain > budget.cap + 1e-12) continue;
        StopProfile profile(5, 250, kDt, budget.cap);
        profile.Begin(speed, rate);
        time = std::max(time, profile.duration());
        distance = std::max(distance, Travelled(Speeds(profile, speed, rate), kDt));
      }
    }
    EXPECT_NEAR(time, budget.time, 1e-9);
    EXPECT_NEAR(distance, budget.distance, 5e-5);
    EXPECT_NEAR(0.003 * budget.cap, budget.detection_travel, 6e-5);
    // Each sent value is held for a tick, so the test checks that the handle travels no further
    // than the continuous curve.
    StopProfile profile(5, 250, kDt, budget.cap);
    const std::vector<double> worst = Speeds(profile, budget.cap - 0.05, 5);
    EXPECT_NEAR(static_cast<double>(worst.size() - 1) * kDt, budget.time, kDt * 1.001);
    EXPECT_LE(*std::max_element(worst.begin(), worst.end()), budget.cap + 1e-12);
  }
}

// Checks speed, acceleration and jerk of the sent values, from before the stop until after it.
TEST(StopProfile, EveryStopKeepsItsBoundsSoak) {
  for (long seed = 1; seed <= Count(3000, 300000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "stop");
    const double a = Between(&random, 0.5, 10), j = Between(&random, 20, 1000);
    const double dt = Between(&random, 0.0005, 0.004);
    const double cap = Between(&random, 0.05, 1);
    const double speed = cap * std::pow(random.Uniform(), 3);
    // The test draws a random acceleration that the motion can have. The acceleration is within the
    // bounds, and the speed stays under the cap while the acceleration fades.
    const double gain = std::min(cap - speed, 0.25 * speed);
    const double highest = std::min(a, std::sqrt(2 * j * gain));
    const double lowest = -std::min(a, std::sqrt(2 * j * speed));
    const double rate = Between(&random, lowest, highest);
    const std::vector<double> v = Speeds(StopProfile(a, j, dt, cap), speed, rate);
    ASSERT_LT(v.size(), 100000U);
    ASSERT_EQ(v.back(), 0);
    double last_rate = rate;
    for (std::size_t k = 1; k <= v.size(); ++k) {
      const double now = k < v.size() ? v[k] : 0;
      const double now_rate = (now - v[k - 1]) / dt;
      ASSERT_GE(now, 0);
      ASSERT_LE(now, std::min(cap, 1.25 * speed) * (1 + 1e-12)) << seed;
      ASSERT_LE(std::abs(now_rate), a * (1 + 1e-9)) << seed << " tick " << k;
      ASSERT_LE(std::abs(now_rate - last_rate), j * dt * (1 + 1e-9) + 1e-10)
          << seed << " tick " << k;
      last_rate = now_rate;
    }
  }
}

// Computes an independent optimum in fine steps. The optimum increases the deceleration with full
// jerk as long as easing off with full jerk would still end above zero speed. Then it eases off.
double GreedyStopTime(double speed, double rate, double a, double j) {
  const double h = 2e-6;
  double v = speed, r = rate, t = 0;
  while (v > 1e-5 && t < 5) {
    const double next = std::max(-a, r - j * h);
    const bool can_ease = v + next * h >= next * next / (2 * j) || next > 0;
    r = can_ease ? next : std::min(0.0, r + j * h);
    v += r * h;
    t += h;
    if (r == 0 && v < 1e-4) break;
  }
  return t;
}

TEST(StopProfile, IsAsShortAsTheBoundsAllow) {
  for (const double speed : {0.02, 0.1, 0.25, 0.5}) {
    for (const double rate : {-2.0, 0.0, 1.0}) {
      StopProfile profile(5, 250, kDt);
      profile.Begin(speed, rate);
      EXPECT_NEAR(profile.duration(), GreedyStopTime(speed, rate, 5, 250), 0.002)
          << speed << " " << rate;
    }
  }
}

TEST(StopProfile, WayIsWhatTheCurveGoes) {
  for (const double speed : {0.001, 0.02, 0.25})
    for (const double rate : {-4.0, -0.3, 0.0, 0.3, 4.0}) {
      StopProfile profile(5, 250, kDt);
      profile.Begin(speed, rate);
      double way = 0;
      const double step = profile.duration() / 10000;
      for (int k = 0; k < 10000; ++k) way += profile.SpeedAt((k + 0.5) * step) * step;
      EXPECT_NEAR(profile.Distance(), way, 1e-6 * way) << speed << " " << rate;
    }
}

TEST(StopProfile, TakesUpABrakingInProgress) {
  StopProfile profile(5, 250, kDt);
  profile.Begin(0.25, -5);
  const double braking = profile.duration();
  EXPECT_DOUBLE_EQ(braking, 0.25 / 5 + 5.0 / 250 / 2);  // v/a plus half of the final ramp
  profile.Begin(0.25, 0);
  EXPECT_NEAR(profile.duration() - braking, 5.0 / 250 / 2, 1e-12);
}

TEST(StopProfile, ARateBeyondWhatMayBeIsCut) {
  for (const double speed : {1e-9, 1e-3, 0.1, 0.24, 0.25, 0.3}) {
    for (const double rate : {-1e6, -20.0, 20.0, 1e6, kNan}) {
      const std::vector<double> v = Speeds(StopProfile(5, 250, kDt, 0.25), speed, rate);
      EXPECT_EQ(v.back(), 0);
      const double highest = rate > 0 ? std::max(speed, std::min(0.25, 1.25 * speed)) : speed;
      EXPECT_LE(*std::max_element(v.begin(), v.end()), highest * (1 + 1e-12));
      // The cut itself changes the acceleration in one step. After this step, the jerk must be
      // bounded again.
      for (std::size_t k = 1; k < v.size(); ++k) {
        const double before = k >= 2 ? v[k - 1] - v[k - 2] : v[k] - v[k - 1];
        ASSERT_LE(std::abs(v[k] - v[k - 1]), 5 * kDt * (1 + 1e-9));
        ASSERT_LE(std::abs(v[k] - v[k - 1] - before), 250 * kDt * kDt * (1 + 1e-9) + 1e-12)
            << speed << " " << rate << " tick " << k;
      }
    }
  }
}

TEST(StopProfile, NothingToStopStopsAtOnce) {
  StopProfile profile(5, 250, kDt);
  EXPECT_TRUE(profile.done());
  EXPECT_EQ(profile.Next(), 0);
  for (const double speed : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    profile.Begin(speed, 3);
    EXPECT_TRUE(profile.done());
    EXPECT_EQ(profile.Next(), 0);
  }
}

}  // namespace
}  // namespace predictor
