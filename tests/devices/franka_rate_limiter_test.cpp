#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.h"
#include "devices/franka/rate_limiter.h"
#include "devices/franka_rig.h"
#include "fakes/franka/motion_check.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor::fci {
namespace {

constexpr double kFraction = 0.95;

double Between(RandomStream* random, double low, double high) {
  return low + (high - low) * random->Uniform();
}

double AnyVelocity(RandomStream* random) {
  switch (random->Next() % 10) {
    case 0:
      return std::numeric_limits<double>::quiet_NaN();
    case 1:
      return std::numeric_limits<double>::infinity();
    case 2:
      return -1e300;
    case 3:
      return 0;
    case 4:
    case 5:
      return random->Next() % 2 == 0 ? 6 : -6;
    case 6:
      return 1e-4 * random->Normal();
    default:
      return 2 * random->Normal();
  }
}

// Computes the differences between commands independently of the limiter and compares them with
// separately defined limits.
struct Differences {
  const FrankaLimits& limits;
  Joints q{}, v{}, a{};
  double acceleration = 0, jerk = 0;  // largest values, relative to the limits

  // Returns the limits that the joint exceeds with v, if any.
  std::string Break(std::size_t i, double v_next) {
    const FrankaJointLimit& l = limits[i];
    const double a_next = (v_next - v[i]) / kDt;
    const double j = (a_next - a[i]) / kDt;
    std::string broken;
    if (!std::isfinite(v_next)) broken += " finite";
    if (v_next > l.FastestUp(q[i]) || -v_next > l.FastestDown(q[i])) broken += " velocity";
    if (std::abs(a_next) > l.acceleration) broken += " acceleration";
    if (std::abs(j) > l.jerk) broken += " jerk";
    acceleration = std::max(acceleration, std::abs(a_next) / l.acceleration);
    jerk = std::max(jerk, std::abs(j) / l.jerk);
    q[i] += v_next * kDt;
    if (q[i] > l.upper || q[i] < l.lower) broken += " range";
    v[i] = v_next;
    a[i] = a_next;
    return broken;
  }
};

class FrankaRateLimiter : public testing::TestWithParam<std::uint16_t> {
 protected:
  const FrankaLimits& limits() const { return FrankaLimitsOf(GetParam()); }
  RateLimiter Limiter() const { return {PublishedLimits(GetParam()), kFraction}; }
  Joints Somewhere(RandomStream* random) const {
    Joints q;
    for (std::size_t i = 0; i < q.size(); ++i)
      q[i] = Between(random, limits()[i].lower + 0.02, limits()[i].upper - 0.02);
    return q;
  }
};

TEST_P(FrankaRateLimiter, SendsNothingBeyondTheLimitsWhateverIsAskedSoak) {
  double acceleration = 0, jerk = 0;
  for (long seed = 0; seed < Count(20, 2000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "limiter");
    RateLimiter limiter = Limiter();
    Differences d{limits(), Somewhere(&random)};
    Joints asked{};
    for (int tick = 0; tick < 3000; ++tick) {
      for (double& v : asked)
        if (random.Next() % 200 == 0) v = AnyVelocity(&random);
      const bool missed = random.Next() % 20 == 0;
      limiter.Next(asked, d.q, missed);
      for (std::size_t i = 0; i < kJoints; ++i) {
        const std::string broken = d.Break(i, limiter.v()[i]);
        ASSERT_EQ(broken, "") << "joint " << i + 1 << ", seed " << seed << ", tick " << tick;
      }
    }
    acceleration = std::max(acceleration, d.acceleration);
    jerk = std::max(jerk, d.jerk);
  }
  // The requests were demanding enough to reach the limits.
  EXPECT_NEAR(acceleration, kFraction, 1e-6);
  EXPECT_NEAR(jerk, kFraction, 1e-6);
}

// At any time, the robot may miss up to 19 milliseconds of commands and continue with constant
// acceleration. During such a gap, the robot must stay within its limits, and the next command must
// be a permitted one.
TEST_P(FrankaRateLimiter, LeavesRoomForCoastingSoak) {
  for (long seed = 0; seed < Count(20, 1000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "coasting");
    RateLimiter limiter = Limiter();
    Differences d{limits(), Somewhere(&random)};
    Joints asked{};
    int coasting = 0, since = 0;
    bool missed = false;
    for (int tick = 0; tick < 3000; ++tick) {
      for (double& v : asked)
        if (random.Next() % 200 == 0) v = AnyVelocity(&random);
      // There is at most one gap in ten milliseconds.
      if (++since > 10 && coasting == 0 && random.Next() % 50 == 0)
        coasting = static_cast<int>(1 + random.Next() % 19);
      if (coasting > 0) {
        --coasting;
        since = 0;
        missed = true;
        for (std::size_t i = 0; i < kJoints; ++i)
          ASSERT_EQ(d.Break(i, d.v[i] + d.a[i] * kDt), "")
              << "joint " << i + 1 << ", seed " << seed << ", tick " << tick;
        continue;
      }
      if (missed) limiter.Start(d.v, d.a);
      limiter.Next(asked, d.q, missed);
      missed = false;
      for (std::size_t i = 0; i < kJoints; ++i)
        ASSERT_EQ(d.Break(i, limiter.v()[i]), "")
            << "joint " << i + 1 << ", seed " << seed << ", tick " << tick;
    }
  }
}

// A velocity ramp that reaches the acceleration limit takes the time v/a + a/j.
TEST_P(FrankaRateLimiter, ReachesAndLeavesAVelocityInTheTimeThatTheLimitsAllow) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    RateLimiter limiter = Limiter();
    const FrankaJointLimit& l = limits()[i];
    const double a = kFraction * l.acceleration, j = kFraction * l.jerk;
    const double speed = 0.5;
    Joints q{}, asked{};
    for (std::size_t k = 0; k < kJoints; ++k) q[k] = (limits()[k].lower + limits()[k].upper) / 2;
    for (const double goal : {speed, 0.0}) {
      asked[i] = goal;
      const double start = limiter.v()[i];
      int ticks = 0;
      for (; limiter.v()[i] != goal && ticks < 1000; ++ticks) {
        limiter.Next(asked, q, false);
        // The velocity must never overshoot the request.
        EXPECT_LE(limiter.v()[i], std::max(start, goal) + 1e-12);
        EXPECT_GE(limiter.v()[i], std::min(start, goal) - 1e-12);
      }
      EXPECT_NEAR(kDt * ticks, speed / a + a / j, 0.003) << "joint " << i + 1;
    }
    limiter.Next(asked, q, false);
    EXPECT_TRUE(limiter.AtRest());
  }
}

// Velocities that the guard permits (accelerations up to half the limits) must pass unchanged.
TEST_P(FrankaRateLimiter, FollowsWhatIsSmoothWithoutDelay) {
  RateLimiter limiter = Limiter();
  Joints q{}, asked{};
  for (std::size_t i = 0; i < kJoints; ++i) q[i] = (limits()[i].lower + limits()[i].upper) / 2;
  double largest = 0;
  for (int tick = 1; tick < 2000; ++tick) {
    const double t = kDt * tick;
    for (std::size_t i = 0; i < kJoints; ++i)
      asked[i] = 0.15 * std::sin(2 * M_PI * 2 * t) * std::sin(M_PI * t / 2);
    limiter.Next(asked, q, false);
    for (std::size_t i = 0; i < kJoints; ++i)
      largest = std::max(largest, std::abs(limiter.v()[i] - asked[i]));
  }
  EXPECT_LT(largest, 1e-9);
}

TEST_P(FrankaRateLimiter, IsNotFasterAfterMissedStates) {
  RateLimiter limiter = Limiter();
  Joints q{}, asked{};
  for (std::size_t i = 0; i < kJoints; ++i) q[i] = (limits()[i].lower + limits()[i].upper) / 2;
  asked.fill(1);
  for (int tick = 0; tick < 40; ++tick) limiter.Next(asked, q, false);
  for (int tick = 0; tick < 5; ++tick) limiter.Next(asked, q, true);
  const Joints before = limiter.v();
  for (int tick = 0; tick < 20; ++tick) limiter.Next(asked, q, true);
  for (std::size_t i = 0; i < kJoints; ++i) EXPECT_EQ(limiter.v()[i], before[i]) << i;
  // The limiter must always be able to stop the joint.
  asked.fill(0);
  for (int tick = 0; tick < 200; ++tick) limiter.Next(asked, q, true);
  EXPECT_TRUE(limiter.AtRest());
}

INSTANTIATE_TEST_SUITE_P(Versions, FrankaRateLimiter,
                         testing::Values(kPandaVersion, kResearch3Version),
                         [](const auto& version) { return ControllerName(version.param); });

TEST(FrankaRateLimiterFraction, IsAPartOfTheLimits) {
  for (const double fraction : {0.0, -1.0, 1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(RateLimiter(PublishedLimits(5), fraction), std::invalid_argument);
  // The joints are far from the ends of their ranges, and the requests exceed the limits.
  for (const std::uint16_t version : {kPandaVersion, kResearch3Version}) {
    const JointLimits& published = PublishedLimits(version);
    for (const double fraction : {0.3, 0.6}) {
      RateLimiter limiter(published, fraction);
      Joints asked{}, middle{};
      asked.fill(100);
      for (std::size_t i = 0; i < middle.size(); ++i)
        middle[i] = (published[i].lower + published[i].upper) / 2;
      double most = 0;
      for (int tick = 0; tick < 3000; ++tick) {
        const double last = limiter.v()[0];
        limiter.Next(asked, middle, false);
        most = std::max(most, (limiter.v()[0] - last) / kDt);
      }
      EXPECT_NEAR(limiter.v()[0], fraction * published[0].velocity, 1e-9);
      EXPECT_LE(most, fraction * published[0].acceleration * (1 + 1e-9));
    }
  }
}

// The limiter must lead the robot from its actual motion back to the requested one without a step
// in velocity or acceleration.
TEST(FrankaWayBack, BeginsWithTheDifferenceAndEndsWithoutOne) {
  Joints v{}, a{};
  v[0] = 0.02, a[0] = 0.5;
  v[1] = -0.003, a[1] = 2;
  WayBack way_back;
  EXPECT_EQ(way_back.Next(), Joints{});
  way_back.Begin(v, a);
  Joints last = v, rate = a;
  const int ticks = static_cast<int>(std::lround(WayBack::kTime / kDt));
  for (int tick = 0; tick < ticks + 2; ++tick) {
    const Joints now = way_back.Next();
    for (std::size_t i = 0; i < 2; ++i) {
      const double now_rate = (now[i] - last[i]) / kDt;
      // The bound follows from the initial values of the cubic's second derivative.
      const double most = 6 * std::abs(v[i]) / (WayBack::kTime * WayBack::kTime) +
                          4 * std::abs(a[i]) / WayBack::kTime;
      EXPECT_LE(std::abs(now_rate - rate[i]), 1.01 * most * kDt) << tick;
      rate[i] = now_rate;
    }
    last = now;
  }
  EXPECT_EQ(last, Joints{});
}

}  // namespace
}  // namespace predictor::fci
