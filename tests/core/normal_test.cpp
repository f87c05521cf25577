#include "core/normal.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

TEST(Normal, QuantilesAreThoseOfScipy) {
  // The expected values are from scipy.stats.norm.ppf.
  EXPECT_NEAR(NormalQuantile(1e-10), -6.361340902404056, 1e-12);
  EXPECT_NEAR(NormalQuantile(0.001), -3.090232306167813, 1e-12);
  EXPECT_NEAR(NormalQuantile(0.3), -0.5244005127080409, 1e-12);
  EXPECT_NEAR(NormalQuantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(NormalProbability(NormalQuantile(0.123)), 0.123, 1e-14);
}

}  // namespace
}  // namespace predictor
