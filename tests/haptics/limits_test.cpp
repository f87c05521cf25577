#include "haptics/limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace predictor {
namespace {

TEST(ApproachSpeed, IsTheVelocityDamperNearTheLimit) {
  // (15): ξ_q (distance) / (q_i − q_s), as long as the deceleration that it asks for is allowed.
  const double gain = 1.0 / 0.28;
  for (const double d : {1e-6, 0.01, 0.1, 0.28})
    EXPECT_DOUBLE_EQ(ApproachSpeed(d, gain, 10), gain * d);
  EXPECT_EQ(ApproachSpeed(0, gain, 10), 0);
  EXPECT_EQ(ApproachSpeed(-0.1, gain, 10), 0);  // beyond the limit: no motion is forced
}

TEST(ApproachSpeed, IsSmooth) {
  RandomStream random(1, "approach");
  for (int i = 0; i < 1000; ++i) {
    const double gain = 0.5 + 10 * random.Uniform();
    const double a = 0.5 + 20 * random.Uniform();
    const double d = a / (gain * gain);  // where line and parabola meet
    const double h = 1e-6 * d;
    EXPECT_NEAR(ApproachSpeed(d + h, gain, a) - ApproachSpeed(d - h, gain, a), 2 * h * gain, 1e-9);
  }
}

// A point that always moves as fast as allowed never needs more than the deceleration, and never
// arrives: checked in discrete time.
TEST(ApproachSpeed, NeverNeedsMoreThanTheDeceleration) {
  RandomStream random(2, "approach");
  constexpr double kDt = 0.001;
  for (int i = 0; i < 300; ++i) {
    const double gain = 0.5 + 10 * random.Uniform();
    const double a = 0.5 + 20 * random.Uniform();
    double d = 3 * random.Uniform();
    double v = ApproachSpeed(d, gain, a);
    for (int k = 0; k < 3000; ++k) {
      d -= v * kDt;
      ASSERT_GE(d, 0);
      const double next = ApproachSpeed(d, gain, a);
      // One step of the line is steeper than its derivative by gain·dt.
      ASSERT_LE((v - next) / kDt, a * (1 + gain * kDt) + 1e-9);
      v = next;
    }
  }
}

}  // namespace
}  // namespace predictor
