// A small dense quadratic program and an interface to its solver (DAQP).
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "core/types.h"

namespace predictor {

// Haptic rendering solves the largest problem (haptics/limit.h). The variables of this problem are
// the joint velocities of two arms and one slack for each row.
inline constexpr int kMaxQpRows = 28;
inline constexpr int kMaxQpVariables = kHands * kMaxArmJoints + kMaxQpRows;

// min ½ xᵀ H x + fᵀ x subject to lower ≤ x ≤ upper and b ≤ A x ≤ b_upper. The sizes are set once,
// and the storage is inside the object. H is symmetric positive definite.
class Qp {
 public:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using MatrixMap = Eigen::Map<RowMajor>;
  using VectorMap = Eigen::Map<Eigen::VectorXd>;
  using ConstMatrixMap = Eigen::Map<const RowMajor>;
  using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;

  Qp(int variables, int rows) : n_(variables), m_(rows) { Clear(); }
  int n() const { return n_; }
  int m() const { return m_; }

  // Sets H, f and A to zero and removes all bounds.
  void Clear() noexcept;

  MatrixMap H() { return {h_.data(), n_, n_}; }
  VectorMap f() { return {f_.data(), n_}; }
  MatrixMap A() { return {a_.data(), m_, n_}; }
  VectorMap lower() { return {lower_.data(), n_}; }
  VectorMap upper() { return {upper_.data(), n_}; }
  VectorMap b() { return {lower_.data() + n_, m_}; }
  VectorMap b_upper() { return {upper_.data() + n_, m_}; }  // no bound unless set
  ConstMatrixMap H() const { return {h_.data(), n_, n_}; }
  ConstVectorMap f() const { return {f_.data(), n_}; }
  ConstMatrixMap A() const { return {a_.data(), m_, n_}; }
  ConstVectorMap lower() const { return {lower_.data(), n_}; }
  ConstVectorMap upper() const { return {upper_.data(), n_}; }
  ConstVectorMap b() const { return {lower_.data() + n_, m_}; }
  ConstVectorMap b_upper() const { return {upper_.data() + n_, m_}; }

 private:
  friend class QpSolver;
  int n_, m_;
  std::array<double, kMaxQpVariables * kMaxQpVariables> h_;
  std::array<double, kMaxQpVariables> f_;
  std::array<double, kMaxQpRows * kMaxQpVariables> a_;
  std::array<double, kMaxQpVariables + kMaxQpRows> lower_, upper_;  // bounds, then rows
};

struct QpSolution {
  std::array<double, kMaxQpVariables> x;
  // The multipliers of the bounds, followed by those of the rows. A multiplier is ≥ 0 at an upper
  // bound and ≤ 0 at a lower bound.
  std::array<double, kMaxQpVariables + kMaxQpRows> multiplier;
  bool solved = false;  // the solver's own report; KktResidual verifies it
  int iterations = 0;
};

// Returns the largest violation of the optimality conditions of (qp, solution). The conditions are
// stationarity relative to max(1, |f|∞, |multipliers|∞), primal feasibility [unit of x], and the
// signs and the complementarity of the multipliers, which are also relative. Returns +inf if the
// solver found no solution. The check of the optimality conditions does not use the solver.
double KktResidual(const Qp& qp, const QpSolution& solution) noexcept;

class QpSolver {
 public:
  // Allocates all memory for problems of this size.
  QpSolver(int variables, int rows);
  ~QpSolver();
  // Solves each problem from scratch, so previously solved problems change the result at most by
  // rounding. Does not use the heap or throw.
  void Solve(const Qp& qp, QpSolution* solution) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
