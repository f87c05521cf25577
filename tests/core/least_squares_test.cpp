#include "core/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace predictor {
namespace {

TEST(StudentQuantile, AsInTables) {
  EXPECT_NEAR(StudentQuantile95(4), 2.7764, 2e-2);
  EXPECT_NEAR(StudentQuantile95(10), 2.2281, 2e-3);
  EXPECT_NEAR(StudentQuantile95(30), 2.0423, 2e-4);
  EXPECT_NEAR(StudentQuantile95(1e6), 1.95996, 1e-4);
}

// The least-squares fit of a line y = a + b x has a well-known closed form.
TEST(FitLinear, OfALineIsTheClosedForm) {
  RandomStream random(1, "line");
  const int n = 12;
  Eigen::MatrixXd A(n, 2);
  Eigen::VectorXd y(n);
  double mean_x = 0, mean_y = 0;
  for (int i = 0; i < n; ++i) {
    A.row(i) << 1, 100 + i * i;
    y[i] = 3 - 0.2 * A(i, 1) + random.Normal();
    mean_x += A(i, 1) / n;
    mean_y += y[i] / n;
  }
  double Sxx = 0, Sxy = 0;
  for (int i = 0; i < n; ++i) {
    Sxx += (A(i, 1) - mean_x) * (A(i, 1) - mean_x);
    Sxy += (A(i, 1) - mean_x) * (y[i] - mean_y);
  }
  const double slope = Sxy / Sxx, start = mean_y - slope * mean_x;
  double squares = 0;
  for (int i = 0; i < n; ++i) squares += std::pow(y[i] - start - slope * A(i, 1), 2);
  const LinearFit fit = FitLinear(A, y);
  EXPECT_EQ(fit.freedom, n - 2);
  EXPECT_NEAR(fit.value[0], start, 1e-9);
  EXPECT_NEAR(fit.value[1], slope, 1e-11);
  EXPECT_NEAR(fit.deviation, std::sqrt(squares / (n - 2)), 1e-9);
  EXPECT_NEAR(fit.spread(1, 1), 1 / Sxx, 1e-9 / Sxx);
  EXPECT_NEAR(fit.spread(0, 0), 1.0 / n + mean_x * mean_x / Sxx, 1e-9);
  EXPECT_NEAR(fit.estimate(1).half_width, 2.2281 * fit.deviation / std::sqrt(Sxx), 1e-3);
}

TEST(FitLinear, OfColumnsThatAreAlikeIsUnsure) {
  Eigen::MatrixXd A(6, 2);
  A << 1, 2, 2, 4, 3, 6, 4, 8, 5, 10, 6, 12;
  const Eigen::VectorXd b = A.col(0) + 0.01 * Eigen::VectorXd::Unit(6, 2);
  const LinearFit fit = FitLinear(A, b);
  EXPECT_TRUE(fit.value.allFinite());
  EXPECT_GT(fit.half_width_95(0), 1e3);
}

}  // namespace
}  // namespace predictor
