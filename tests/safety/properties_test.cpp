// Tests properties of the guard and the stop for arbitrary inputs with RapidCheck, which shrinks
// counterexamples:
//   - every sent value is finite and bounded, for any command and any measurement;
//   - from every motion within the bounds, a stop keeps to its closed-form budget.
// guard_test.cpp, stop_profile_test.cpp and stop_test.cpp compare the same code with plants and
// optima.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "safety/guard.h"
#include "safety/stop.h"
#include "support/constants.h"
#include "support/rapidcheck.h"

namespace predictor {
namespace {

using Arms = std::array<JointVector, kHands>;

// ---- the guard ----------------------------------------------------------------------------------

constexpr std::array<int, kHands> kJoints = {3, 2};

// The input of one joint in one tick.
struct JointInput {
  double q, v;
};

// The values of all joints that the guard receives in one tick. `missing` is an arm that provides
// too few numbers or none. `passed` is the number of ticks since the last command, which exceeds
// one after missed deadlines.
struct Tick {
  std::vector<JointInput> joints;
  int missing;
  int passed;
};

// Generates the number of ticks between two commands, with arbitrary jitter.
rc::Gen<int> SomePassed() { return rc::gen::inRange(1, 5); }

std::array<JointBounds, kHands> SomeBounds() {
  std::array<JointBounds, kHands> bounds;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    JointBounds& b = bounds[arm];
    for (JointVector* x : {&b.lower, &b.upper, &b.velocity, &b.acceleration})
      x->resize(kJoints[arm]);
    for (int i = 0; i < kJoints[arm]; ++i) {
      b.lower[i] = *test::Between(-3, 1);
      b.upper[i] = b.lower[i] + *test::Between(0.01, 4);
      b.velocity[i] = *test::Between(0.1, 4);
      b.acceleration[i] = *test::Between(1, 40);
    }
  }
  return bounds;
}

// If `broken`, the values may also be NaN or infinite.
rc::Gen<JointInput> SomeJointInput(bool broken) {
  const auto number = broken
                          ? rc::gen::weightedOneOf<double>(
                                {{8, test::Between(-6, 6)},
                                 {1, rc::gen::element(kNan, kInf, -kInf, 1e300, -1e300, -1e-310)}})
                          : test::Between(-6, 6);
  return rc::gen::construct<JointInput>(number, number);
}

rc::Gen<std::vector<Tick>> SomeTicks(bool broken) {
  const auto joints = rc::gen::container<std::vector<JointInput>>(5, SomeJointInput(broken));
  const auto missing = rc::gen::weightedElement<int>(
      {{broken ? 20 : 1, -1}, {broken ? 1 : 0, 0}, {broken ? 1 : 0, 1}});
  return rc::gen::container<std::vector<Tick>>(
      rc::gen::construct<Tick>(joints, missing, SomePassed()));
}

void Split(const Tick& tick, Arms* q, Arms* v) {
  std::size_t k = 0;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    (*q)[arm].resize(kJoints[arm]);
    (*v)[arm].resize(kJoints[arm]);
    for (int i = 0; i < kJoints[arm]; ++i, ++k) {
      (*q)[arm][i] = tick.joints[k].q;
      (*v)[arm][i] = tick.joints[k].v;
    }
    if (tick.missing == static_cast<int>(arm)) (*v)[arm].resize(0);
  }
}

// Positions jump, are unknown or lie far beyond the limits. Commands are arbitrary and may come
// late. A joint's velocity may change by more than a tick's acceleration only towards zero, but not
// past zero. After missed ticks, the change may be as large as the sum of the changes allowed in
// all these ticks. The change may be larger only if a joint limit is known to be near.
TEST(GuardProperties, WhateverIsMeasuredAndAskedWhatIsSentIsBoundedSoak) {
  EXPECT_TRUE(rc::check([] {
    const auto bounds = SomeBounds();
    Guard guard(bounds, kDt, *test::Between(0, 0.03));
    const auto ticks = *SomeTicks(true);
    for (const Tick& tick : ticks) {
      Arms q, v;
      Split(tick, &q, &v);
      const Arms last = guard.last();
      guard.Apply(q, &v, tick.passed);
      for (std::size_t arm = 0; arm < kHands; ++arm) {
        RC_ASSERT(v[arm].size() == kJoints[arm]);
        RC_ASSERT(v[arm] == guard.last()[arm]);
        for (int i = 0; i < kJoints[arm]; ++i) {
          const double now = v[arm][i], before = last[arm][i], at = q[arm][i];
          RC_ASSERT(std::abs(now) <= bounds[arm].velocity[i]);
          const double step = bounds[arm].acceleration[i] * kDt * (1 + 1e-9);
          const bool yields = std::min(before, 0.0) <= now && now <= std::max(before, 0.0);
          RC_ASSERT(std::abs(now - before) <= step || yields);
          RC_ASSERT(std::abs(now - before) <= tick.passed * step || std::isfinite(at));
          RC_ASSERT(!(at > bounds[arm].upper[i]) || !std::isfinite(at) || now <= 0);
          RC_ASSERT(!(at < bounds[arm].lower[i]) || !std::isfinite(at) || now >= 0);
        }
      }
    }
  }));
}

// The sent value is the allowed value nearest to the commanded one. The guard therefore alters only
// values that are not allowed, and a value that it has sent passes unchanged a second time.
TEST(GuardProperties, AltersNoMoreThanItMustSoak) {
  EXPECT_TRUE(rc::check([] {
    const auto bounds = SomeBounds();
    Guard guard(bounds, kDt, *test::Between(0, 0.03));
    const auto ticks = *SomeTicks(false);
    for (const Tick& tick : ticks) {
      Arms q, v;
      Split(tick, &q, &v);
      const Arms asked = v;
      Guard down = guard, up = guard, again = guard;
      Arms lowest = asked, highest = asked;
      for (std::size_t arm = 0; arm < kHands; ++arm) {
        lowest[arm].setConstant(-1e9);
        highest[arm].setConstant(1e9);
      }
      down.Apply(q, &lowest, tick.passed);
      up.Apply(q, &highest, tick.passed);
      guard.Apply(q, &v, tick.passed);
      for (std::size_t arm = 0; arm < kHands; ++arm)
        for (int i = 0; i < kJoints[arm]; ++i)
          RC_ASSERT(v[arm][i] == std::clamp(asked[arm][i], lowest[arm][i], highest[arm][i]));
      RC_ASSERT(again.Apply(q, &v, tick.passed) == 0);
    }
  }));
}

// ---- the stop -----------------------------------------------------------------------------------

struct Limits {
  double acceleration, jerk, cap;  // [m/s²], [m/s³], [m/s] >= acceleration²/jerk
};

struct Motion {
  double speed = 0, rate = 0;  // speed and rate of the faster handle [m/s], [m/s²]
};

// Returns the motion after one tick with `jerk` (−1, 0 or 1 times the limit). If the motion would
// leave the bounds with this jerk, the jerk is replaced by one with which the motion stays within
// them. The speed then remains under the cap after the acceleration has faded, and does not cross
// zero.
Motion Next(const Motion& from, int jerk, const Limits& limits) {
  const double step = limits.jerk * kDt;
  const auto moved = [&](double rate) { return Motion{from.speed + rate * kDt, rate}; };
  const double wanted =
      std::clamp(from.rate + jerk * step, -limits.acceleration, limits.acceleration);
  const Motion to = moved(wanted);
  const double peak = to.rate * std::abs(to.rate) / (2 * limits.jerk);
  if (to.speed + std::max(0.0, peak) > limits.cap) return moved(from.rate - step);
  if (to.speed + std::min(0.0, peak) < 0) return moved(std::min(from.rate + step, 0.0));
  return to;
}

struct Piece {
  int jerk, ticks;
};

// Generates a motion that can be reached from rest within the limits.
Motion SomeMotion(const Limits& limits) {
  const auto pieces = *rc::gen::container<std::vector<Piece>>(
      rc::gen::construct<Piece>(rc::gen::element(-1, 0, 1, 1), rc::gen::inRange(1, 60)));
  Motion motion;
  for (const Piece& piece : pieces)
    for (int k = 0; k < piece.ticks; ++k) motion = Next(motion, piece.jerk, limits);
  motion.speed = std::max(0.0, motion.speed);
  return motion;
}

// Among all motions under the cap, a motion at full acceleration that is about to reach the cap has
// the longest stop.
double LongestTime(const Limits& l) { return l.cap / l.acceleration + 2 * l.acceleration / l.jerk; }
double LongestWay(const Limits& l) {
  const double a = l.acceleration, j = l.jerk;
  return l.cap * a / j - a * a * a / (6 * j * j) + l.cap * l.cap / (2 * a) + l.cap * a / (2 * j);
}

TEST(StopProperties, TheBudgetsAreThoseOfTheLimits) {
  EXPECT_NEAR(LongestTime({5, 250, 0.25}), 0.090, 1e-12);
  EXPECT_NEAR(LongestWay({5, 250, 0.25}), 0.0134, 5e-5);
  EXPECT_NEAR(LongestTime({5, 250, 0.5}), 0.140, 1e-12);
  EXPECT_NEAR(LongestWay({5, 250, 0.5}), 0.0397, 5e-5);
}

Limits SomeLimits() {
  const double a = *test::Between(1, 10), j = *test::Between(50, 1000);
  return {a, j, a * a / j + *test::Between(0.01, 1)};
}

// Returns joint bounds that limit a handle's deceleration to `allowed` [m/s²] if each joint moves
// at one rad/s for each m/s of the handle.
std::array<JointBounds, kHands> BoundsThatAllow(double allowed) {
  std::array<JointBounds, kHands> bounds;
  for (JointBounds& b : bounds) {
    b.lower = JointVector::Constant(1, -100);
    b.upper = b.velocity = JointVector::Constant(1, 100);
    b.acceleration = JointVector::Constant(1, allowed / StopController::kShareOfJoints);
  }
  return bounds;
}

struct Stop {
  double time = 0, way = 0, fastest = 0;  // [s], [m], [m/s]
};

// The numbers of ticks that pass before each command, repeated cyclically. If the list is empty,
// one tick passes before each command.
using Passed = std::vector<int>;
rc::Gen<Passed> SomeJitter() { return rc::gen::container<Passed>(SomePassed()); }
int At(const Passed& passed, int command) {
  return passed.empty() ? 1 : passed[static_cast<std::size_t>(command) % passed.size()];
}
int Most(const Passed& passed) {
  return passed.empty() ? 1 : *std::max_element(passed.begin(), passed.end());
}

// Stops `motion`. At the commands in the list `again`, the test requests another stop with a
// different motion.
Stop RunStop(const Motion& motion, const Limits& limits, double allowed, const Passed& passed,
             const std::vector<int>& again) {
  SafetySpec safety;
  safety.stop_acceleration = limits.acceleration;
  safety.stop_jerk = limits.jerk;
  safety.handle_speed = limits.cap;
  StopController stop(safety, BoundsThatAllow(allowed), kDt);
  const Arms last = {JointVector::Constant(1, motion.speed),
                     JointVector::Constant(1, -0.3 * motion.speed)};
  stop.Begin({StopCause::kForce, 0, 31, 30}, 1, last, motion.speed, motion.rate);
  Stop result;
  Arms v = last;
  for (int command = 0; !stop.commands_rest(); ++command) {
    RC_ASSERT(command < 100'000);
    if (std::find(again.begin(), again.end(), command) != again.end())
      stop.Begin({StopCause::kOperator}, 2, last, limits.cap, limits.acceleration);
    stop.Next(&v, At(passed, command));
    RC_ASSERT(v[0].allFinite() && v[1].allFinite());
    // Both arms are in the same phase of the stop.
    RC_ASSERT(std::abs(v[1][0] + 0.3 * v[0][0]) <= 1e-12 * limits.cap);
    result.time += At(passed, command) * kDt;
    result.way += v[0][0] * At(passed, command + 1) * kDt;  // held until the next command
    result.fastest = std::max(result.fastest, v[0][0]);
  }
  return result;
}

// A sent velocity applies for a whole tick, so a handle that still accelerates travels this much
// further. If a velocity is held for several ticks, it is the velocity of the first of these ticks.
double Held(const Stop& stop, const Motion& motion, const Passed& passed) {
  const double late = (Most(passed) - 1) * stop.fastest * kDt;
  return Most(passed) * std::max(0.0, stop.fastest - motion.speed) * kDt + late;
}

TEST(StopProperties, FromEveryMotionThatMayBeTheBudgetIsKeptSoak) {
  EXPECT_TRUE(rc::check([] {
    const Limits limits = SomeLimits();
    const Motion motion = SomeMotion(limits);
    const auto passed = *SomeJitter();
    const Stop stop = RunStop(motion, limits, kInf, passed, {});
    RC_ASSERT(stop.fastest <= limits.cap * (1 + 1e-9));
    RC_ASSERT(stop.time <= LongestTime(limits) + Most(passed) * kDt);
    RC_ASSERT(stop.way <= LongestWay(limits) + Held(stop, motion, passed));
  }));
}

// If the joints cannot brake as hard as the profile requires, the budget is computed with the
// deceleration that the joints allow.
TEST(StopProperties, WeakerJointsHaveTheBudgetOfWhatTheyAllowSoak) {
  EXPECT_TRUE(rc::check([] {
    const Limits limits = SomeLimits();
    const Motion motion = SomeMotion(limits);
    const double allowed = limits.acceleration * *test::Between(0.1, 1);
    const auto passed = *SomeJitter();
    const Stop stop = RunStop(motion, limits, allowed, passed, {});
    const Limits weaker = {allowed, limits.jerk, limits.cap};
    RC_ASSERT(stop.fastest <= limits.cap * (1 + 1e-9));
    RC_ASSERT(stop.time <= LongestTime(weaker) + Most(passed) * kDt);
    RC_ASSERT(stop.way <= LongestWay(weaker) + Held(stop, motion, passed));
  }));
}

TEST(StopProperties, AskingAgainNeitherProlongsNorHastensItSoak) {
  EXPECT_TRUE(rc::check([] {
    const Limits limits = SomeLimits();
    const Motion motion = SomeMotion(limits);
    const auto again = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 100));
    const auto passed = *SomeJitter();
    const Stop once = RunStop(motion, limits, kInf, passed, {}),
               often = RunStop(motion, limits, kInf, passed, again);
    RC_ASSERT(once.time == often.time);
    RC_ASSERT(once.way == often.way);
    RC_ASSERT(once.fastest == often.fastest);
  }));
}

}  // namespace
}  // namespace predictor
