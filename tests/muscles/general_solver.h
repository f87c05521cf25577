// Solves activation problems with a general solver for quadratic programs.
#pragma once

#include <limits>

#include "muscles/activation.h"
#include "qp/qp.h"

namespace predictor::muscles {

// Returns the same problem as a quadratic program in activations and reserves.
inline Qp ProgramOf(const ActivationProblem& p) {
  constexpr int kJoints = person::kArmJoints;
  Qp qp(kMuscles + kJoints, kJoints);
  for (int i = 0; i < kMuscles; ++i) {
    qp.H()(i, i) = p.weight[i];
    qp.lower()[i] = p.lower[i];
    qp.upper()[i] = p.upper[i];
  }
  for (int j = 0; j < kJoints; ++j) {
    qp.H()(kMuscles + j, kMuscles + j) = p.reserve_cost;
    qp.A().row(j).head<kMuscles>() = p.torque.row(j);
    qp.A()(j, kMuscles + j) = 1;
    qp.b()[j] = qp.b_upper()[j] = p.target[j];
  }
  return qp;
}

class GeneralSolver {
 public:
  // Returns the minimum cost of a problem with power 2 and without measured activations, or NaN if
  // the solver does not find it.
  double CostOf(const ActivationProblem& problem) {
    const Qp qp = ProgramOf(problem);
    QpSolution solution;
    solver_.Solve(qp, &solution);
    if (!solution.solved) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::Map<const Eigen::VectorXd> x(solution.x.data(), qp.n());
    return x.dot(qp.H() * x) / 2;
  }

 private:
  QpSolver solver_{kMuscles + person::kArmJoints, person::kArmJoints};
};

}  // namespace predictor::muscles
