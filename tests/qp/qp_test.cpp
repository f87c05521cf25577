// Compares the solver with the optimality conditions and with another solver. The problems resemble
// the problems of rendering. They contain rank-deficient least squares, widely differing weights,
// boxes, and soft rows.
#include "qp/qp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <eiquadprog/eiquadprog-fast.hpp>

#include "core/random.h"

namespace predictor {
namespace {

constexpr int kJoints = 14;
constexpr int kN = kJoints + 7;  // plus a slack for each row
constexpr int kM = 7;            // the relative pose, and one inequality

// Minimises ½|J x − v|² + ½ρ|A x − r|² + ½ε|x|² for x within a box. One additional inequality is
// soft, with a weight of 1e9. Each row has a slack that is scaled to a weight of 1. J may be
// singular.
Qp RandomQp(RandomStream* random, double relative_weight, double epsilon, double box) {
  bool singular = false;
  Qp qp(kN, kM);
  Eigen::Matrix<double, 12, kJoints> J;
  for (int i = 0; i < J.size(); ++i) J.data()[i] = random->Normal();
  if (random->Uniform() < 0.3) J.row(3) = J.row(4) * (1 + 1e-6 * random->Normal()), singular = true;
  if (random->Uniform() < 0.2) J.row(7).setZero(), singular = true;
  // rendering increases its regularisation near a singularity as well
  if (singular) epsilon = 1e-2;
  Eigen::Matrix<double, 12, 1> v;
  for (int i = 0; i < 12; ++i) v[i] = 0.2 * random->Normal();
  qp.H().topLeftCorner(kJoints, kJoints) = J.transpose() * J;
  qp.H().topLeftCorner(kJoints, kJoints).diagonal().array() += epsilon;
  qp.f().head(kJoints) = -J.transpose() * v;
  qp.A().topLeftCorner(6, kJoints) = J.topRows<6>() - J.bottomRows<6>();
  for (int k = 0; k < kM; ++k) {
    qp.H()(kJoints + k, kJoints + k) = 1;
    qp.A()(k, kJoints + k) = 1 / std::sqrt(k < 6 ? relative_weight : 1e9);
    if (k < 6) qp.b()[k] = qp.b_upper()[k] = 0.01 * random->Normal();
  }
  for (int j = 0; j < kJoints; ++j) {
    const double center = box * random->Normal();
    const double half = random->Uniform() < 0.1 ? 0 : box * random->Uniform();
    qp.lower()[j] = center - half;
    qp.upper()[j] = center + half;
    qp.A()(6, j) = random->Normal();
  }
  qp.b()[6] = 0.2 * random->Normal();
  return qp;
}

struct Optimality {
  double stationarity = 0, primal = 0, dual = 0, complementarity = 0;
};

// Evaluates each optimality condition with dense matrices, so that it shares no code with the
// product's own check. All constraints are rows C x with lo ≤ C x ≤ up.
Optimality Conditions(const Qp& qp, const QpSolution& s) {
  const int n = qp.n(), rows = qp.n() + qp.m();
  Eigen::MatrixXd C(rows, n);
  C << Eigen::MatrixXd::Identity(n, n), qp.A();
  Eigen::VectorXd lo(rows), up(rows);
  lo << qp.lower(), qp.b();
  up << qp.upper(), qp.b_upper();
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(s.x.data(), n);
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(s.multiplier.data(), rows);
  const Eigen::VectorXd at_upper = y.cwiseMax(0), at_lower = (-y).cwiseMax(0), value = C * x;
  const double scale = 1 + y.cwiseAbs().maxCoeff();
  Optimality o;
  o.stationarity = (qp.H() * x + qp.f() + C.transpose() * (at_upper - at_lower)).norm() / scale;
  for (int k = 0; k < rows; ++k) {
    o.primal = std::max({o.primal, lo[k] - value[k], value[k] - up[k]});
    if (up[k] < 1e29) o.complementarity += at_upper[k] * std::abs(up[k] - value[k]) / scale;
    if (lo[k] > -1e29) o.complementarity += at_lower[k] * std::abs(value[k] - lo[k]) / scale;
    // An open bound must not have a multiplier.
    if (up[k] >= 1e29) o.dual = std::max(o.dual, at_upper[k] / scale);
    if (lo[k] <= -1e29) o.dual = std::max(o.dual, at_lower[k] / scale);
  }
  return o;
}

// With damping, as in rendering's last attempt, the solver must solve every problem. With little
// regularisation, the solver may give up, and rendering then makes its last attempt
// (tests/haptics/renderer_test.cpp).
TEST(QpSolver, MeetsTheOptimalityConditionsWhenDamped) {
  RandomStream random(1, "qp");
  QpSolver solver(kN, kM);
  QpSolution solution;
  for (int i = 0; i < 20'000; ++i) {
    const Qp qp = RandomQp(&random, 1e5, 1e-2, std::pow(10, -3 + 4 * random.Uniform()));
    solver.Solve(qp, &solution);
    ASSERT_LT(KktResidual(qp, solution), 1e-6) << i;
    const Optimality o = Conditions(qp, solution);
    ASSERT_LT(o.stationarity, 1e-6) << i;
    ASSERT_LT(o.primal, 1e-6) << i;
    ASSERT_LT(o.dual, 1e-6) << i;
    ASSERT_LT(o.complementarity, 1e-6) << i;
  }
}

TEST(QpSolver, AgreesWithAnotherSolver) {
  RandomStream random(2, "qp");
  QpSolver solver(kN, kM);
  QpSolution solution;
  eiquadprog::solvers::EiquadprogFast other;
  other.reset(kN, 6, 2 * kJoints + 1);
  for (int i = 0; i < 500; ++i) {
    const Qp qp = RandomQp(&random, 100, 1e-2, 0.3);
    solver.Solve(qp, &solution);
    ASSERT_TRUE(solution.solved);
    // The constraints of the other solver have the form CE x + ce0 = 0, CI x + ci0 ≥ 0.
    const Eigen::MatrixXd CE = qp.A().topRows(6);
    const Eigen::VectorXd ce0 = -qp.b().head(6);
    Eigen::MatrixXd CI = Eigen::MatrixXd::Zero(2 * kJoints + 1, kN);
    Eigen::VectorXd ci0(2 * kJoints + 1);
    for (int j = 0; j < kJoints; ++j) {
      CI(2 * j, j) = 1, ci0[2 * j] = -qp.lower()[j];
      CI(2 * j + 1, j) = -1, ci0[2 * j + 1] = qp.upper()[j];
    }
    CI.bottomRows(1) = qp.A().bottomRows(1);
    ci0.tail(1) = -qp.b().tail(1);
    Eigen::VectorXd x(kN);
    const auto status = other.solve_quadprog(qp.H(), qp.f(), CE, ce0, CI, ci0, x);
    ASSERT_EQ(status, eiquadprog::solvers::EIQUADPROG_FAST_OPTIMAL);
    EXPECT_LT((x - Eigen::Map<Eigen::VectorXd>(solution.x.data(), kN))
                  .head(kJoints)
                  .lpNorm<Eigen::Infinity>(),
              1e-6);
  }
}

// The check itself must detect every kind of error.
TEST(KktResidual, DetectsWrongSolutions) {
  RandomStream random(3, "qp");
  QpSolver solver(kN, kM);
  QpSolution solution;
  int at_bound = 0;
  for (int i = 0; i < 200; ++i) {
    const Qp qp = RandomQp(&random, 100, 1e-2, 0.1);
    solver.Solve(qp, &solution);
    ASSERT_LT(KktResidual(qp, solution), 1e-5);
    QpSolution moved = solution;
    moved.x[3] += 1e-3;
    EXPECT_GT(KktResidual(qp, moved), 1e-5);
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(solution.multiplier[j]) < 1e-3) continue;
      ++at_bound;
      QpSolution flipped = solution;
      flipped.multiplier[j] = -flipped.multiplier[j];
      EXPECT_GT(KktResidual(qp, flipped), 1e-5);
    }
    QpSolution nan = solution;
    nan.x[0] = std::nan("");
    EXPECT_GT(KktResidual(qp, nan), 1e6);
  }
  EXPECT_GT(at_bound, 100);
}

TEST(QpSolver, DependsOnTheProblemAlone) {
  RandomStream random(4, "qp");
  QpSolver used(kN, kM);
  QpSolution a, b;
  for (int i = 0; i < 100; ++i) {
    const Qp qp = RandomQp(&random, 1e5, 1e-5, 0.1);
    used.Solve(qp, &a);
    QpSolver fresh(kN, kM);
    fresh.Solve(qp, &b);
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(a.x[j], b.x[j], 1e-9);
  }
}

}  // namespace
}  // namespace predictor
