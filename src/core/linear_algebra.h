// Decompositions of matrices of any size, compiled once: elsewhere each costs seconds of every
// build. They allocate: not for the tick.
#pragma once

#include <Eigen/Core>

namespace predictor {

// A = V diag(λ) V⁻¹ of a square matrix.
struct Modes {
  Eigen::VectorXcd eigenvalues;   // λ
  Eigen::MatrixXcd eigenvectors;  // V, of unit length
};
Modes ModesOf(const Eigen::MatrixXd& A);
Eigen::VectorXcd EigenvaluesOf(const Eigen::MatrixXd& A);

// K W = M W diag(λ), Wᵀ M W = 1, for K symmetric and M symmetric and positive definite; λ ascends.
struct SymmetricModes {
  Eigen::VectorXd eigenvalues;
  Eigen::MatrixXd eigenvectors;
};
SymmetricModes SymmetricModesOf(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

// X of A X = B, A square and regular.
Eigen::MatrixXd Solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// x that minimizes |A x − b|, the smallest where there are several.
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace predictor
