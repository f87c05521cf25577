#include "safety/guard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "core/random.h"
#include "safety/between.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor {
namespace {

using Arms = std::array<JointVector, kHands>;

JointBounds RandomBounds(RandomStream* random, int joints) {
  JointBounds b;
  for (JointVector* v : {&b.lower, &b.upper, &b.velocity, &b.acceleration}) v->resize(joints);
  for (int i = 0; i < joints; ++i) {
    b.lower[i] = Between(random, -3, 1);
    b.upper[i] = b.lower[i] + Between(random, 0.01, 4);
    b.velocity[i] = Between(random, 0.1, 4);
    b.acceleration[i] = Between(random, 1, 40);
  }
  return b;
}

// Returns a value that a broken program might send. Most values are not finite or far beyond the
// limits.
double AnyNumber(RandomStream* random) {
  switch (random->Next() % 12) {
    case 0:
      return kNan;
    case 1:
      return kInf;
    case 2:
      return -kInf;
    case 3:
      return 1e300;
    case 4:
      return -1e-310;
    case 5:
      return 0;
    case 6:
    case 7:
      return 5;
    case 8:
    case 9:
      return -5;
    default:
      return random->Normal();
  }
}

// An input that stays constant for a while, so that the joints can move far.
class Input {
 public:
  Input(RandomStream* random, bool broken) : random_(random), broken_(broken) {}
  void Next(const Arms& sizes, Arms* v) {
    if (left_-- <= 0) {
      left_ = static_cast<int>(Between(random_, 1, 400));
      for (std::size_t arm = 0; arm < kHands; ++arm) {
        held_[arm].resize(sizes[arm].size());
        for (auto& x : held_[arm]) x = broken_ ? AnyNumber(random_) : 4 * random_->Normal();
      }
      // A broken program may also send too few or too many values.
      if (broken_ && random_->Next() % 8 == 0) held_[random_->Next() % kHands].setZero(3);
      if (broken_) left_ = random_->Next() % 2 ? left_ : 1;
    }
    *v = held_;
  }

 private:
  RandomStream* random_;
  bool broken_;
  int left_ = 0;
  Arms held_;
};

struct Plant {
  std::array<JointBounds, kHands> bounds;
  Arms q;

  Plant(RandomStream* random, int left, int right) {
    bounds = {RandomBounds(random, left), RandomBounds(random, right)};
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      q[arm].resize(bounds[arm].lower.size());
      for (int i = 0; i < q[arm].size(); ++i) {
        q[arm][i] = Between(random, bounds[arm].lower[i], bounds[arm].upper[i]);
      }
    }
  }
  bool Within(double tolerance) const {
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      if ((q[arm].array() > bounds[arm].upper.array() + tolerance).any()) return false;
      if ((q[arm].array() < bounds[arm].lower.array() - tolerance).any()) return false;
    }
    return true;
  }
};

// Applies 20 random commands. `v` contains the last command as the guard modified it.
void ApplyRandomCommands(const Plant& plant, RandomStream* random, Guard* guard, Arms* v) {
  for (int tick = 0; tick < 20; ++tick) {
    for (std::size_t arm = 0; arm < kHands; ++arm)
      (*v)[arm] = JointVector::Constant(plant.q[arm].size(), 0.1 * random->Normal());
    guard->Apply(plant.q, v);
  }
}

// Returns whether the number of values is right and all values are finite and within the velocity
// bounds.
bool Sendable(const Plant& plant, const Arms& v) {
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    if (v[arm].size() != plant.q[arm].size() || !v[arm].allFinite()) return false;
    if ((v[arm].array().abs() > plant.bounds[arm].velocity.array()).any()) return false;
  }
  return true;
}

double LargestAccelerationRatio(const Plant& plant, const Arms& v, const Arms& last, double dt) {
  double ratio = 0;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    for (int i = 0; i < v[arm].size(); ++i) {
      const double a = std::abs(v[arm][i] - last[arm][i]) / dt;
      ratio = std::max(ratio, a / plant.bounds[arm].acceleration[i]);
    }
  }
  return ratio;
}

TEST(Guard, AnyInputGivesASendableCommandThatNeverCrossesALimitSoak) {
  for (long seed = 1; seed <= Count(100, 20000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "guard");
    const double dt = Between(&random, 0.0005, 0.008);
    Plant plant(&random, 7, static_cast<int>(random.Next() % 8));
    Guard guard(plant.bounds, dt);
    Input input(&random, true);
    for (int k = 0; k < 1500; ++k) {
      Arms v, last = guard.last();
      input.Next(plant.q, &v);
      const int altered = guard.Apply(plant.q, &v);
      ASSERT_GE(altered, 0);
      ASSERT_TRUE(Sendable(plant, v)) << seed;
      ASSERT_LE(LargestAccelerationRatio(plant, v, last, dt), 1 + 1e-9) << seed << " tick " << k;
      for (std::size_t arm = 0; arm < kHands; ++arm) {
        ASSERT_EQ(v[arm], guard.last()[arm]);
        plant.q[arm] += v[arm] * dt;
      }
      ASSERT_TRUE(plant.Within(1e-12)) << seed << " tick " << k;
    }
  }
}

// The joints respond late by whole ticks, and their measured positions are equally old. The
// reaction time covers both delays.
TEST(Guard, NeverCrossesALimitInADelayedLoopSoak) {
  for (long seed = 1; seed <= Count(100, 20000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "delayed");
    const double dt = 0.001;
    const int delay = static_cast<int>(random.Next() % 40);
    Plant plant(&random, 7, 6);
    Guard guard(plant.bounds, dt, delay * dt);
    Input input(&random, false);
    std::deque<Arms> sent(static_cast<std::size_t>(delay), guard.last());
    for (int k = 0; k < 1500; ++k) {
      Arms v, last = guard.last();
      input.Next(plant.q, &v);
      guard.Apply(plant.q, &v);
      ASSERT_TRUE(Sendable(plant, v));
      ASSERT_LE(LargestAccelerationRatio(plant, v, last, dt), 1 + 1e-9) << seed << " tick " << k;
      sent.push_back(v);
      for (std::size_t arm = 0; arm < kHands; ++arm) plant.q[arm] += sent.front()[arm] * dt;
      sent.pop_front();
      ASSERT_TRUE(plant.Within(1e-12)) << seed << " tick " << k << " delay " << delay;
    }
  }
}

// The ticks may be early, or late by up to three ticks.
TEST(Guard, NeverCrossesALimitUnderJitterSoak) {
  for (long seed = 1; seed <= Count(100, 20000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "jitter");
    const double dt = 0.001;
    Plant plant(&random, 7, 7);
    Guard guard(plant.bounds, dt, 3 * dt);
    Input input(&random, true);
    for (int k = 0; k < 1500; ++k) {
      Arms v;
      input.Next(plant.q, &v);
      guard.Apply(plant.q, &v);
      ASSERT_TRUE(Sendable(plant, v));
      const double passed = dt * (random.Next() % 3 == 0 ? 4 : Between(&random, 0.1, 4));
      for (std::size_t arm = 0; arm < kHands; ++arm) plant.q[arm] += v[arm] * passed;
      ASSERT_TRUE(plant.Within(1e-12)) << seed << " tick " << k;
    }
  }
}

JointBounds OneJoint(double lower, double upper, double velocity, double acceleration) {
  return {JointVector::Constant(1, lower), JointVector::Constant(1, upper),
          JointVector::Constant(1, velocity), JointVector::Constant(1, acceleration)};
}

double ApplyOne(Guard* guard, double q, double v, int ticks = 1) {
  Arms command = {JointVector::Constant(1, v), JointVector()};
  guard->Apply({JointVector::Constant(1, q), JointVector()}, &command, ticks);
  return command[0][0];
}

// Returns the highest position of a joint with a limit at 1 rad. The joint starts at 0, is always
// commanded to move up as fast as it can, and follows a second-order loop with delay.
double HighestPosition(const VelocityLoopSpec& loop, double speed, double acceleration) {
  const double w = 2 * std::numbers::pi * loop.bandwidth, zeta = loop.damping_ratio;
  const double dt = 0.001;
  Guard guard({OneJoint(-1, 1, speed, acceleration), JointBounds{}}, dt, ReactionTime(loop));
  std::deque<double> sent(static_cast<std::size_t>(std::lround(loop.delay / dt)), 0.0);
  double q = 0, v = 0, v_rate = 0, highest = 0;
  for (int k = 0; k < 8000; ++k) {
    sent.push_back(ApplyOne(&guard, q, 10));
    for (int fine = 0; fine < 10; ++fine) {
      v_rate += (w * w * (sent.front() - v) - 2 * zeta * w * v_rate) * dt / 10;
      v += v_rate * dt / 10;
      q += v * dt / 10;
    }
    sent.pop_front();
    highest = std::max(highest, q);
  }
  return highest;
}

TEST(Guard, NeverCrossesALimitInALoopLikeTheRigs) {
  for (const double bandwidth : {10.0, 15.0, 25.0}) {
    for (const double damping_ratio : {0.7, 0.8, 0.9, 1.2}) {
      for (const double delay : {0.0, 0.004, 0.014}) {
        for (const double acceleration : {4.0, 10.0, 20.0}) {
          for (const double speed : {0.3, 1.0, 2.2}) {
            const VelocityLoopSpec loop{bandwidth, damping_ratio, delay};
            const double highest = HighestPosition(loop, speed, acceleration);
            EXPECT_LE(highest, damping_ratio < 0.8 ? 1.001 : 1.0)
                << bandwidth << " Hz, " << damping_ratio << ", " << delay << " s, " << acceleration
                << " rad/s², " << speed << " rad/s";
            EXPECT_GE(highest, 0.96);
          }
        }
      }
    }
  }
}

TEST(Guard, BeyondALimitOnlyMotionBackIsAllowed) {
  Guard guard({OneJoint(-1, 1, 2, 10), JointBounds{}}, 0.001);
  EXPECT_EQ(ApplyOne(&guard, 1.2, 0.5), 0);
  EXPECT_DOUBLE_EQ(ApplyOne(&guard, 1.2, -0.5), -0.01);
  for (int k = 0; k < 100; ++k) ApplyOne(&guard, 1.2, -0.5);
  EXPECT_DOUBLE_EQ(ApplyOne(&guard, 1.2, -0.5), -0.5);
  // The joint is suddenly beyond the other limit while it moves outwards, so the acceleration limit
  // must yield.
  EXPECT_EQ(ApplyOne(&guard, -1.1, -0.5), 0);
  EXPECT_DOUBLE_EQ(ApplyOne(&guard, -1.1, 0.5), 0.01);
}

// After missed deadlines, a larger change must be allowed only if it brings a joint nearer to rest.
TEST(Guard, AfterMissedTicksAJointMayBrakeByThemAllAndSpeedUpByOne) {
  for (const double sign : {1.0, -1.0}) {
    Guard guard({OneJoint(-9, 9, 2, 10), JointBounds{}}, 0.001);
    EXPECT_DOUBLE_EQ(ApplyOne(&guard, 0, sign, 4), sign * 0.01);  // from rest
    for (int k = 0; k < 9; ++k) ApplyOne(&guard, 0, sign);
    EXPECT_DOUBLE_EQ(ApplyOne(&guard, 0, sign, 4), sign * 0.11);
    EXPECT_NEAR(ApplyOne(&guard, 0, 0, 4), sign * 0.07, 1e-15);
    EXPECT_NEAR(ApplyOne(&guard, 0, -sign, 4), sign * 0.03, 1e-15);
    EXPECT_NEAR(ApplyOne(&guard, 0, -sign, 4), 0, 1e-15);  // to rest, and
    EXPECT_NEAR(ApplyOne(&guard, 0, -sign, 4), -sign * 0.01, 1e-15);
  }
}

TEST(Guard, NormalCommandsPassUnaltered) {
  RandomStream random(3, "normal");
  Plant plant(&random, 7, 7);
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    plant.bounds[arm] = {JointVector::Constant(7, -2), JointVector::Constant(7, 2),
                         JointVector::Constant(7, 2), JointVector::Constant(7, 10)};
    plant.q[arm].setZero();
  }
  Guard guard(plant.bounds, 0.001, 0.025);
  for (int k = 0; k < 5000; ++k) {
    Arms v;
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      v[arm].resize(7);
      for (int i = 0; i < 7; ++i) v[arm][i] = 0.8 * std::sin(0.0015 * k * (i + 1));
    }
    const Arms asked = v;
    ASSERT_EQ(guard.Apply(plant.q, &v), 0);
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      ASSERT_EQ(v[arm], asked[arm]);
      plant.q[arm] += v[arm] * 0.001;
    }
  }
}

// Two joints brake, and one joint needs more time than the other joint.
TEST(Guard, OneBadNumberBrakesBothArmsByOneFactor) {
  for (const double bad : {kNan, kInf, -kInf}) {
    for (const std::size_t slow : {0U, 1U}) {
      const std::size_t quick = 1 - slow;
      std::array<JointBounds, kHands> bounds;
      bounds[quick] = OneJoint(-9, 9, 2, 10);
      bounds[slow] = OneJoint(-9, 9, 2, 5);
      Guard guard(bounds, 0.001);
      const Arms q = {JointVector::Zero(1), JointVector::Zero(1)};
      Arms v = q;
      for (int k = 0; k < 300; ++k) {
        v[quick][0] = 0.9;
        v[slow][0] = -0.6;
        guard.Apply(q, &v);
      }
      ASSERT_DOUBLE_EQ(v[quick][0], 0.9);
      ASSERT_DOUBLE_EQ(v[slow][0], -0.6);
      int ticks = 0;
      for (; v[quick][0] != 0 && ticks < 1000; ++ticks) {
        v[1][0] = bad;
        EXPECT_EQ(guard.Apply(q, &v), 2);
        EXPECT_NEAR(v[slow][0], -v[quick][0] / 1.5, 1e-15);
      }
      EXPECT_EQ(ticks, 120);  // 0.6 rad/s at 5 rad/s²
      EXPECT_EQ(v[slow][0], 0);
    }
  }
}

// The commands of both arms change by the same fraction of the way from the last command to the
// slowed command, as far as the joints' accelerations allow. Any quantity that is linear in the
// command then stays between its values for the last command and for the slowed one.
TEST(Guard, SlowsBothArmsByTheSameFraction) {
  RandomStream random(7, "slow");
  int whole = 0, part = 0;
  for (int k = 0; k < 2000; ++k) {
    Plant plant(&random, 7, 6);
    Guard guard(plant.bounds, 0.001);
    Arms v, goal;
    ApplyRandomCommands(plant, &random, &guard, &v);
    const double factor = random.Uniform(), size = random.Next() % 2 ? 0.001 : 0.1;
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      v[arm] = guard.last()[arm] / factor;
      for (auto& x : v[arm]) x += size * random.Normal();
      goal[arm] = factor * v[arm];
    }
    EXPECT_EQ(guard.Slow(factor, &v), 13);
    double share = -1, tightest = 0;
    for (std::size_t arm = 0; arm < kHands; ++arm)
      for (int j = 0; j < v[arm].size(); ++j) {
        const double last = guard.last()[arm][j], way = goal[arm][j] - last;
        const double step = plant.bounds[arm].acceleration[j] * 0.001;
        if (share < 0) share = (v[arm][j] - last) / way;
        EXPECT_NEAR(v[arm][j], last + share * way, 1e-12);
        tightest = std::max(tightest, std::abs(v[arm][j] - last) / step);
      }
    EXPECT_LE(tightest, 1 + 1e-9);
    EXPECT_TRUE(share > 1 - 1e-9 || tightest > 1 - 1e-9);
    (share > 1 - 1e-9 ? whole : part)++;
  }
  EXPECT_GT(whole, 100);
  EXPECT_GT(part, 100);
}

// If the last command has become too fast because of the arms' posture, the way begins at the last
// command scaled by one factor. The factor must not cause joint accelerations beyond the limits.
TEST(Guard, SlowsFromALastCommandThatBecameTooFast) {
  RandomStream random(8, "became too fast");
  int kept = 0, yielded = 0;
  for (int k = 0; k < 2000; ++k) {
    Plant plant(&random, 7, 6);
    Guard guard(plant.bounds, 0.001);
    Arms v, goal;
    ApplyRandomCommands(plant, &random, &guard, &v);
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      for (auto& x : v[arm]) x += 0.1 * random.Normal();
      goal[arm] = v[arm];
    }
    double least = 0;  // the smallest factor that the accelerations allow
    for (std::size_t arm = 0; arm < kHands; ++arm)
      for (int j = 0; j < v[arm].size(); ++j)
        if (const double last = std::abs(guard.last()[arm][j]); last > 0)
          least = std::max(least, 1 - plant.bounds[arm].acceleration[j] * 0.001 / last);
    const double factor = random.Uniform(), keep = std::max(factor, least);
    guard.Slow(1, &v, factor);
    (factor > least ? kept : yielded)++;
    double share = -1, tightest = 0;
    for (std::size_t arm = 0; arm < kHands; ++arm)
      for (int j = 0; j < v[arm].size(); ++j) {
        const double last = guard.last()[arm][j], from = keep * last, way = goal[arm][j] - from;
        if (share < 0) share = (v[arm][j] - from) / way;
        EXPECT_NEAR(v[arm][j], from + share * way, 1e-12);
        tightest = std::max(
            tightest, std::abs(v[arm][j] - last) / (plant.bounds[arm].acceleration[j] * 0.001));
      }
    EXPECT_GE(share, -1e-9);
    EXPECT_LE(share, 1 + 1e-9);
    EXPECT_LE(tightest, 1 + 1e-9);
    EXPECT_TRUE(share > 1 - 1e-9 || tightest > 1 - 1e-9);
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(yielded, 100);
}

TEST(Guard, SlowsNothingThatIsReachedOrCannotBeRead) {
  Guard guard({OneJoint(-9, 9, 2, 10), OneJoint(-9, 9, 2, 10)}, 0.001);
  Arms v = {JointVector::Constant(1, 0.01), JointVector::Constant(1, -0.003)};
  EXPECT_EQ(guard.Slow(1, &v), 0);
  EXPECT_EQ(v[0][0], 0.01);
  EXPECT_EQ(v[1][0], -0.003);
  Arms none = {JointVector::Constant(1, 0.5), JointVector()};
  EXPECT_EQ(guard.Slow(0.5, &none), 0);
  EXPECT_EQ(none[0][0], 0.5);  // Apply corrects it
}

TEST(Guard, AnUnknownPositionBrakes) {
  Guard guard({OneJoint(-9, 9, 2, 10), JointBounds{}}, 0.001);
  for (int k = 0; k < 100; ++k) ApplyOne(&guard, 0, 0.5);
  EXPECT_DOUBLE_EQ(ApplyOne(&guard, kNan, 0.5), 0.49);
  Arms v = {JointVector::Constant(1, 0.5), JointVector()};
  EXPECT_EQ(guard.Apply({JointVector(), JointVector()}, &v), 1);
  EXPECT_DOUBLE_EQ(v[0][0], 0.48);
  guard.Reset();
  EXPECT_EQ(guard.last()[0][0], 0);
}

// The braking speed is the largest speed from which braking in whole ticks ends before the limit.
TEST(Guard, BrakingSpeedIsTheLargestThatStops) {
  for (const double distance : {1e-9, 1e-6, 1e-4, 0.01, 1.0}) {
    for (const double dt : {0.0005, 0.001, 0.008}) {
      const double a = 10;
      const auto travelled = [&](double v) {  // v in this tick, then a·dt less in each tick
        double sum = 0;
        for (; v > 0; v -= a * dt) sum += v * dt;
        return sum;
      };
      const double v = BrakingSpeed(distance, a, 0, dt);
      EXPECT_LE(travelled(v), distance * (1 + 1e-9));
      // A speed that is higher by half a tick's deceleration would be too fast, because the error
      // of the overestimate v dt + v²/2a is smaller than this difference.
      EXPECT_GT(travelled(v + a * dt / 2 + 1e-9), distance);
    }
  }
  EXPECT_EQ(BrakingSpeed(-1, 10, 0, 0.001), 0);
  EXPECT_EQ(BrakingSpeed(kNan, 10, 0, 0.001), 0);
  EXPECT_EQ(BrakingSpeed(kInf, 10, 0, 0.001), kInf);
}

}  // namespace
}  // namespace predictor
