// Least squares, and how sure what they find is. They allocate: not for the tick.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace predictor {

// A value and the half-width of its 95 % interval.
struct Estimate {
  double value = 0;
  double half_width = 0;
};

// Two-sided 95 % quantile of Student's t.
double StudentQuantile95(double degrees_of_freedom);

// x that minimizes |A x − b|, where the errors of b are alike and independent.
struct LinearFit {
  Eigen::VectorXd value;     // x
  Eigen::VectorXd residual;  // b − A x
  Eigen::MatrixXd spread;    // (AᵀA)⁻¹: covariance of x over the variance of an error
  double deviation = 0;      // of an error, as the residuals show it; 0 without freedom
  int freedom = 0;           // rows less columns

  double half_width_95(int i) const {
    return StudentQuantile95(freedom) * deviation * std::sqrt(spread(i, i));
  }
  Estimate estimate(int i) const { return {value[i], half_width_95(i)}; }
};

// Of at least as many rows as columns. Where A does not tell columns apart the spread is huge.
LinearFit FitLinear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace predictor
