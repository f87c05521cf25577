// Checks the stability of the haptic loop with a cobot under admittance control. The test compares
// the simulation with the linear model, which has states for the sensor, the controller and the
// delay.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "analysis/stability_map/growth.h"
#include "haptics/stability.h"
#include "scenarios.h"
#include "simulation/world.h"
#include "support/soak.h"

namespace predictor {
namespace {

// A mode that grows faster than this rate counts as unstable [1/s].
constexpr double kUnstableRate = 0.05;
constexpr double kLightest = 0.3, kHeaviest = 12;  // hands [kg]

double RateOf(const HapticLoop& loop, HandSpec hand, double mass) {
  hand.mass = mass;
  return loop.GrowthRate(hand, 0, 1);
}

// Returns the mass of the hand at which the loop becomes unstable [kg], or no value if no mass in
// the range is critical.
std::optional<double> CriticalMass(const Scenario& s) {
  const HapticLoop loop(World(s).Linearise(), s, 1 / s.rate, LoopModel::kExact);
  const HandSpec& hand = s.operator_.hand;
  double stable = kLightest, unstable = kHeaviest;
  if (RateOf(loop, hand, stable) > kUnstableRate || RateOf(loop, hand, unstable) < kUnstableRate)
    return {};
  while (unstable > 1.005 * stable) {
    const double middle = std::sqrt(stable * unstable);
    (RateOf(loop, hand, middle) > kUnstableRate ? unstable : stable) = middle;
  }
  return stable;
}

Scenario LoopWith(double stiffness, double delay) {
  // A weak virtual spring holds the cobot, because the effect of a tap on a free cobot would never
  // decay.
  Scenario s =
      Load("admittance.yaml", {"cobot.controller.virtual_stiffness.translation=[80, 80, 80]",
                               "cobot.controller.virtual_stiffness.rotation=[5, 5, 5]"});
  s.cobot.control.delay = delay;
  s.rendering.lead = 0;
  s.operator_.hand.stiffness = Vector3::Constant(stiffness);
  return s;
}

bool Grows(Scenario s, double mass) {
  s.operator_.hand.mass = mass;
  const Growth growth = MeasureGrowth(s, 0);
  // Once a disturbance has decayed, only rounding errors are left, and the measured rate is about
  // 0. If no rate could be measured, a limit acted from the start of the run.
  return growth.grows && growth.rate.value_or(1) > 0.2;
}

// The full test covers 24 points, and the short test covers four of these points.
TEST(Admittance, CriticalHandMassIsAsPredictedSoak) {
  int point = 0, compared = 0;
  for (const double stiffness : {60.0, 100.0, 170.0, 280.0, 400.0, 600.0})
    for (const double delay : {0.0, 0.002, 0.005, 0.010}) {
      if (!InFull() && point++ % 6 != 0) continue;
      const Scenario s = LoopWith(stiffness, delay);
      const std::optional<double> critical = CriticalMass(s);
      ASSERT_TRUE(critical) << stiffness << " N/m, " << delay << " s";
      const bool below = Grows(s, 0.8 * *critical), above = Grows(s, 1.2 * *critical);
      EXPECT_FALSE(below) << stiffness << " N/m, " << delay << " s, " << *critical << " kg";
      EXPECT_TRUE(above) << stiffness << " N/m, " << delay << " s, " << *critical << " kg";
      std::printf("%.0f N/m, %.0f ms: %.2f kg\n", stiffness, 1e3 * delay, *critical);
      ++compared;
    }
  EXPECT_EQ(compared, InFull() ? 24 : 4);
  std::printf("soak: count=%d\n", compared);
}

}  // namespace
}  // namespace predictor
