// Decompositions of matrices of any size. These functions are compiled in only one file. Otherwise,
// each of them would lengthen the compilation of every file that uses it by seconds. These
// functions allocate memory, so the tick must not use them.
#pragma once

#include <Eigen/Core>

namespace predictor {

// A = V diag(λ) V⁻¹ for a square matrix A.
struct Modes {
  Eigen::VectorXcd eigenvalues;   // λ
  Eigen::MatrixXcd eigenvectors;  // V, columns of unit length
};
Modes ModesOf(const Eigen::MatrixXd& A);
Eigen::VectorXcd EigenvaluesOf(const Eigen::MatrixXd& A);

// K W = M W diag(λ), Wᵀ M W = 1. K is symmetric, M is symmetric and positive definite, and λ is in
// ascending order.
struct SymmetricModes {
  Eigen::VectorXd eigenvalues;
  Eigen::MatrixXd eigenvectors;
};
SymmetricModes SymmetricModesOf(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

// The same with M = 1.
SymmetricModes SymmetricModesOf(const Eigen::MatrixXd& K);
Eigen::VectorXd SymmetricEigenvaluesOf(const Eigen::MatrixXd& K);

// Solves A X = B for X. A is square and regular.
Eigen::MatrixXd Solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// Returns the x that minimises |A x − b|. If several x minimise this norm, the function returns the
// smallest x.
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace predictor
