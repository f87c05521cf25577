#include "haptics/approach_speed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "support/constants.h"

namespace predictor {
namespace {

TEST(ApproachSpeed, IsTheVelocityDamperNearTheLimit) {
  // According to equation (15), the speed is ξ_q (distance) / (q_i − q_s), as long as the required
  // deceleration is allowed.
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
    const double d = a / (gain * gain);  // the line meets the parabola here
    const double h = 1e-6 * d;
    EXPECT_NEAR(ApproachSpeed(d + h, gain, a) - ApproachSpeed(d - h, gain, a), 2 * h * gain, 1e-9);
  }
}

// A point that always moves at the allowed speed must never exceed the deceleration and never reach
// the limit. The test checks this in discrete time.
TEST(ApproachSpeed, NeverNeedsMoreThanTheDeceleration) {
  RandomStream random(2, "approach");
  for (int i = 0; i < 300; ++i) {
    const double gain = 0.5 + 10 * random.Uniform();
    const double a = 0.5 + 20 * random.Uniform();
    double d = 3 * random.Uniform();
    double v = ApproachSpeed(d, gain, a);
    for (int k = 0; k < 3000; ++k) {
      d -= v * kDt;
      ASSERT_GE(d, 0);
      const double next = ApproachSpeed(d, gain, a);
      // A step along the line is steeper than the line's derivative by gain·dt.
      ASSERT_LE((v - next) / kDt, a * (1 + gain * kDt) + 1e-9);
      v = next;
    }
  }
}

}  // namespace
}  // namespace predictor
