// Compares the linear loop that predicts the stability map with closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/spring_and_mass.h"
#include "analysis/stability_map/stability_map.h"
#include "support/constants.h"

namespace predictor {
namespace {

constexpr double kRounding = 1e-3;  // growth rate that rounding alone can cause [1/s]

// Returns a hand that consists of a spring along x and a delayed reflex.
HandSpec SpringWithReflex(double stiffness, double reflex_gain, double reflex_delay) {
  HandSpec hand = Spring(stiffness);
  hand.reflex_gain = reflex_gain;
  hand.reflex_delay = reflex_delay;
  return hand;
}

// For ωT = 2π n + π/2, s = jω solves M s² + B s + K (1 + g e^−sT) = 0 if M ω² = K and B = g K/ω. If
// too few states model the delay, its phase is wrong at this frequency.
TEST(ExactLoop, ModelsTheReflexAfterWholeTurnsOfItsPhase) {
  const double T = 0.060, g = 0.4, mass = 2;
  for (const int turns : {0, 1}) {
    const double omega = (2 * kPi * turns + kPi / 2) / T;  // 4 Hz, 21 Hz
    const double stiffness = mass * omega * omega;
    const double critical = g * stiffness / omega;
    const Scenario s = PureDelay(0);
    const HandSpec hand = SpringWithReflex(stiffness, g, T);
    double frequency = 0;
    const HapticLoop less(Mass(mass, 0.97 * critical), s, kDt, LoopModel::kExact);
    const HapticLoop more(Mass(mass, 1.03 * critical), s, kDt, LoopModel::kExact);
    EXPECT_GT(less.GrowthRate(hand, 0, 1, &frequency), 0) << turns;
    EXPECT_NEAR(frequency, omega / (2 * kPi), 0.02 * omega / (2 * kPi)) << turns;
    EXPECT_LT(more.GrowthRate(hand, 0, 1), kRounding) << turns;
  }
}

// For M s² + B s + K e^−sT, the boundary is at M ω² = K cos ωT and B ω = K sin ωT. The model must
// not add a tick to the delay.
TEST(ExactLoop, HasOnlyItsOwnDelay) {
  const double T = 0.040, mass = 9, omega = 20;
  const double stiffness = mass * omega * omega / std::cos(omega * T);
  const double critical = stiffness * std::sin(omega * T) / omega;
  const Scenario s = PureDelay(T);
  const HandSpec hand = SpringWithReflex(stiffness, 0, T);
  for (const double share : {0.99, 1.01}) {
    const HapticLoop loop(Mass(mass, share * critical), s, kDt, LoopModel::kExact);
    EXPECT_EQ(loop.GrowthRate(hand, 0, 1) > kRounding, share < 1) << share;
  }
  // The loop model that selects the leads has a delay that is longer by 1.5 ticks. In this test,
  // the longer delay raises the critical mass by 2 or 3 %.
  const HapticLoop reserved(Mass(mass, 1.01 * critical), s, kDt);
  EXPECT_GT(reserved.GrowthRate(hand, 0, 1), kRounding);
}

// For M s² + B s + K (1 + τ s) e^−sT, a lead with unfiltered acceleration must differ from a lead
// of zero.
TEST(ExactLoop, AnUnfilteredLeadLeads) {
  const double T = 0.040, lead = 0.020, mass = 9, omega = 15;
  const double c = std::cos(omega * T), si = std::sin(omega * T);
  const double stiffness = mass * omega * omega / (c + lead * omega * si);
  const double critical = stiffness * (si - lead * omega * c) / omega;
  Scenario s = PureDelay(T);
  s.rendering.lead_cutoff = 0;
  for (const double share : {0.97, 1.03}) {
    const HapticLoop loop(Mass(mass, share * critical), s, kDt, LoopModel::kExact);
    EXPECT_EQ(loop.GrowthRate(SpringWithReflex(stiffness, 0, T), lead, 1) > kRounding, share < 1)
        << share;
  }
}

TEST(PredictExtent, FindsTheClosedForm) {
  const Scenario s = PureDelay(0.02);
  const HapticLoop loop(Mass(9, 15), s, kDt, LoopModel::kExact);
  const StableExtent extent = PredictExtent(loop, SpringWithReflex(100, 0, 0.06), 0, {20, 10000});
  ASSERT_TRUE(extent.stable_at_softest);
  ASSERT_EQ(extent.boundaries.size(), 1u);
  const double critical = extent.critical()->stiffness;
  const double omega = 2 * kPi * extent.critical()->frequency;
  EXPECT_NEAR(critical, 15 * omega / std::sin(omega * 0.02), 0.03 * critical);
  EXPECT_NEAR(9 * omega * omega, critical * std::cos(omega * 0.02), 0.03 * critical);
}

}  // namespace
}  // namespace predictor
