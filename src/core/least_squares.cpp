#include "core/least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"

namespace predictor {
namespace {

constexpr double kMinMode = 1e-15;  // smallest eigenvalue of a Gram matrix of unit columns

}  // namespace

double StudentQuantile95(double n) {
  // Uses the Cornish–Fisher expansion about the normal quantile.
  const double z = 1.959963985;
  n = std::max(n, 3.0);
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

LinearFit FitLinear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  LinearFit fit;
  const Eigen::VectorXd unit = A.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = A * unit.asDiagonal();
  const SymmetricModes modes =
      SymmetricModesOf(scaled.transpose() * scaled, Eigen::MatrixXd::Identity(A.cols(), A.cols()));
  const Eigen::MatrixXd V = unit.asDiagonal() * modes.eigenvectors;
  fit.spread = V * modes.eigenvalues.cwiseMax(kMinMode).cwiseInverse().asDiagonal() * V.transpose();
  fit.value = LeastSquares(A, b);
  fit.residual = b - A * fit.value;
  fit.freedom = static_cast<int>(A.rows() - A.cols());
  if (fit.freedom > 0) fit.deviation = std::sqrt(fit.residual.squaredNorm() / fit.freedom);
  return fit;
}

}  // namespace predictor
