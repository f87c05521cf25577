#include "sensing/motion_differentiator.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

ArmSample SampleAt(double t, std::uint64_t sequence) {
  ArmSample sample;
  sample.v.resize(2);
  sample.v << 3 * t * t, 1 - 2 * t;
  sample.arm_sequence = sequence;
  return sample;
}

TEST(MotionDifferentiator, IsExactHalfASampleAgoForAQuadratic) {
  const double dt = 0.001;
  MotionDifferentiator differentiator(dt);
  EXPECT_EQ(differentiator.Update(SampleAt(0, 0)).norm(), 0);  // no earlier sample to compare with
  for (int k = 1; k < 100; ++k) {
    const JointVector& a = differentiator.Update(SampleAt(k * dt, static_cast<std::uint64_t>(k)));
    const double then = k * dt - MotionDifferentiator::Lag(dt);
    EXPECT_NEAR(a[0], 6 * then, 1e-10);
    EXPECT_NEAR(a[1], -2, 1e-10);
  }
}

TEST(MotionDifferentiator, HoldsBetweenTheSamplesOfASlowerArm) {
  const double dt = 0.001;
  MotionDifferentiator differentiator(dt);
  for (int k = 0; k < 40; ++k) {
    const int sample = k / 4;  // a new sample every fourth tick
    const JointVector& a =
        differentiator.Update(SampleAt(sample * 4 * dt, static_cast<std::uint64_t>(sample)));
    if (sample == 0) continue;
    EXPECT_NEAR(a[1], -2, 1e-10) << k;
    EXPECT_NEAR(a[0], 6 * (sample * 4 - 2) * dt, 1e-10) << k;
  }
}

TEST(MotionDifferentiator, StartsAgainAfterAReset) {
  MotionDifferentiator differentiator(0.001);
  differentiator.Update(SampleAt(0, 0));
  differentiator.Update(SampleAt(0.001, 1));
  differentiator.Reset();
  EXPECT_EQ(differentiator.Update(SampleAt(5, 2)).norm(), 0);  // no jump
}

}  // namespace
}  // namespace predictor
