// Least-squares fits and the uncertainty of their results. These functions allocate memory, so the
// tick must not use them.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace predictor {

// A value and the half-width of its 95 % interval.
struct Estimate {
  double value = 0;
  double half_width = 0;
};

// Returns the two-sided 95 % quantile of Student's t.
double StudentQuantile95(double degrees_of_freedom);

// x that minimises |A x − b|. The errors of b must be independent and have equal variance.
struct LinearFit {
  Eigen::VectorXd value;     // x
  Eigen::VectorXd residual;  // b − A x
  Eigen::MatrixXd spread;    // (AᵀA)⁻¹: covariance of x divided by the variance of one error
  double deviation = 0;  // standard deviation of one error, from the residuals; 0 if freedom is 0
  int freedom = 0;       // number of rows minus number of columns

  double half_width_95(int i) const {
    return StudentQuantile95(freedom) * deviation * std::sqrt(spread(i, i));
  }
  Estimate estimate(int i) const { return {value[i], half_width_95(i)}; }
};

// The matrix A has at least as many rows as columns. If the columns of A are nearly dependent, the
// spread is very large.
LinearFit FitLinear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace predictor
