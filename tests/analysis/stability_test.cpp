// Compares the stability margin with closed forms and with a time-domain simulation of the same
// loop.
#include "haptics/stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/spring_and_mass.h"
#include "support/constants.h"

namespace predictor {
namespace {

// Returns one arm whose only dynamics are a delay [s] from the virtual to the real handle and back.
Scenario PureLoopDelay(double delay) {
  Scenario s;
  s.left_handle.emplace();
  s.device.left.emplace();
  s.device.left->loop = {20000, 1, delay - 1.5 * kDt};
  s.device.left->sensor.cutoff_frequency = 0;
  s.device.left->sensor.delay = 0;
  s.rendering.kp = s.rendering.ko = 0;
  return s;
}

struct Case {
  double mass, stiffness, delay, damper;
};

// For M s² + B s + g K e^{−sT}, the stability limit is at g K cos ωT = M ω² and g K sin ωT = B ω,
// so tan ωT = B / (M ω).
StabilityMargin ClosedForm(const Case& c) {
  double low = 0;
  double high = kPi / 2 / c.delay;
  for (int i = 0; i < 200; ++i) {
    const double omega = (low + high) / 2;
    (std::tan(omega * c.delay) < c.damper / (c.mass * omega) ? low : high) = omega;
  }
  return {c.mass * low * low / (c.stiffness * std::cos(low * c.delay)), low / (2 * kPi)};
}

TEST(StabilityMargin, OfADelayedSpringIsItsClosedForm) {
  for (const Case& c : {Case{9, 300, 0.02, 15}, Case{9, 300, 0.02, 30}, Case{2, 400, 0.03, 25},
                        Case{20, 1000, 0.01, 30}, Case{5, 200, 0.06, 9}}) {
    const Scenario s = PureLoopDelay(c.delay);
    const HapticLoop loop(Mass(c.mass, c.damper), s, kDt);
    const StabilityMargin margin = loop.Margin(Spring(c.stiffness), 0);
    const StabilityMargin expected = ClosedForm(c);
    ASSERT_LT(expected.gain, HapticLoop::kLargestGain);
    EXPECT_NEAR(margin.gain / expected.gain, 1, 0.03) << c.mass << " kg, " << c.delay << " s";
    EXPECT_NEAR(margin.frequency / expected.frequency, 1, 0.03)
        << c.mass << " kg, " << c.delay << " s";
  }
}

// The smallest sufficient damper is B = K sin(ωT)/ω with M ω² = K cos ωT.
TEST(StabilityMargin, CriticalDampingOfADelayedSpringIsItsClosedForm) {
  const double mass = 9, stiffness = 400, delay = 0.03;
  double low = 0, high = kPi / 2 / delay;
  for (int i = 0; i < 200; ++i) {
    const double omega = (low + high) / 2;
    (mass * omega * omega < stiffness * std::cos(omega * delay) ? low : high) = omega;
  }
  const double critical = stiffness * std::sin(low * delay) / low;
  const Scenario s = PureLoopDelay(delay);
  const HapticLoop damped(Mass(mass, 1.05 * critical), s, kDt);
  const HapticLoop undamped(Mass(mass, 0.95 * critical), s, kDt);
  EXPECT_GE(damped.Margin(Spring(stiffness), 0).gain, 1);
  EXPECT_LT(undamped.Margin(Spring(stiffness), 0).gain, 1);
  EXPECT_GT(undamped.GrowthRate(Spring(stiffness), 0, 1), 0);
  EXPECT_GT(critical, 0.9 * stiffness * delay * std::cos(low * delay));  // near the rule B ≈ K T
}

// Simulates one axis of the whole chain in small steps with a true delay line. The chain consists
// of the reference with lead, the delay, the second-order arm, the hand with its mass, spring and
// damper, the sensor filter, and the mass. Returns the largest deflection in the last quarter
// divided by that in the second quarter. The loop grows if this ratio is above 1.
double GrowthOf(const Scenario& s, const HandSpec& hand, double mass, double damper, double lead,
                double gain) {
  constexpr double kStep = 2e-5;
  constexpr int kSteps = 400000;
  const ArmSpec& arm = *s.device.left;
  const double delay = arm.loop.delay + kDt / 2 + arm.sensor.delay + kDt;
  std::vector<double> line(static_cast<std::size_t>(std::lround(delay / kStep)), 0);
  const double cutoff = 2 * kPi * s.rendering.lead_cutoff;
  const double w = 2 * kPi * arm.loop.bandwidth;
  const double k = hand.stiffness.x();
  const double d = 2 * hand.damping_ratio * std::sqrt(hand.mass * k);
  double x = 1, v = 0, filtered = 0, h = 1, vh = 0, ah = 0, force = 0, early = 0, late = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = v + lead * cutoff * (v - filtered) + s.rendering.kp * (x - h);
    double& slot = line[static_cast<std::size_t>(i) % line.size()];
    const double delayed = slot;
    slot = u;
    const double jerk = w * w * (delayed - vh) - 2 * arm.loop.damping_ratio * w * ah;
    const double felt = -gain * (k * h + d * vh + hand.mass * ah);
    filtered += kStep * cutoff * (v - filtered);
    force += kStep * 2 * kPi * arm.sensor.cutoff_frequency * (felt - force);
    ah += kStep * jerk;
    vh += kStep * ah;
    h += kStep * vh;
    v += kStep * (force - damper * v) / mass;
    x += kStep * v;
    if (i >= kSteps / 4 && i < kSteps / 2) early = std::max(early, std::fabs(x));
    if (i >= 3 * kSteps / 4) late = std::max(late, std::fabs(x));
  }
  return late / early;
}

TEST(StabilityMargin, IsWhereTheSimulatedLoopBeginsToGrow) {
  Scenario s;
  s.left_handle.emplace();
  s.device.left.emplace();
  HandSpec hand = Spring(500);
  hand.damping_ratio = 0.1;
  for (const double hand_mass : {1.0, 3.0})
    for (const double lead : {0.0, 0.02}) {
      hand.mass = hand_mass;
      const double mass = 4, damper = 3;
      const HapticLoop loop(Mass(mass, damper), s, kDt);
      const StabilityMargin margin = loop.Margin(hand, lead);
      ASSERT_GT(margin.gain, 0.05);
      ASSERT_LT(margin.gain, HapticLoop::kLargestGain) << hand_mass << " kg, lead " << lead;
      EXPECT_LT(GrowthOf(s, hand, mass, damper, lead, 0.94 * margin.gain), 1)
          << hand_mass << " kg, lead " << lead;
      EXPECT_GT(GrowthOf(s, hand, mass, damper, lead, 1.06 * margin.gain), 1)
          << hand_mass << " kg, lead " << lead;
    }
}

}  // namespace
}  // namespace predictor
