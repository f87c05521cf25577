// The solver against the optimality conditions and against another solver, on problems built the
// way rendering builds them: least squares of rank below n, weights far apart, boxes, soft rows.
#include "haptics/qp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <eiquadprog/eiquadprog-fast.hpp>

#include "core/random.h"

namespace predictor {
namespace {

constexpr int kN = 15;  // 14 joints and one slack
constexpr int kM = 1;

// min ½|J x − v|² + ½ρ|A x − r|² + ½ε|x|² + ½s², box, one soft row. `rank` of J below 12 makes it
// singular but for ε.
Qp RandomQp(RandomStream* random, double relative_weight, double epsilon, double box) {
  Qp qp(kN, kM);
  Eigen::Matrix<double, 12, 14> J;
  for (int i = 0; i < J.size(); ++i) J.data()[i] = random->Normal();
  if (random->Uniform() < 0.3) J.row(3) = J.row(4) * (1 + 1e-6 * random->Normal());  // near singular
  if (random->Uniform() < 0.2) J.row(7).setZero();
  const Eigen::Matrix<double, 6, 14> A = J.topRows<6>() - J.bottomRows<6>();
  Eigen::Matrix<double, 12, 1> v;
  Eigen::Matrix<double, 6, 1> r;
  for (int i = 0; i < 12; ++i) v[i] = 0.2 * random->Normal();
  for (int i = 0; i < 6; ++i) r[i] = 0.01 * random->Normal();
  qp.H().topLeftCorner(14, 14) = J.transpose() * J + relative_weight * A.transpose() * A;
  qp.H().topLeftCorner(14, 14).diagonal().array() += epsilon;
  qp.H()(14, 14) = 1;
  qp.f().head(14) = -J.transpose() * v - relative_weight * A.transpose() * r;
  for (int j = 0; j < 14; ++j) {
    const double center = box * random->Normal();
    const double half = random->Uniform() < 0.1 ? 0 : box * random->Uniform();
    qp.lower()[j] = center - half;
    qp.upper()[j] = center + half;
    qp.A()(0, j) = random->Normal();
  }
  qp.A()(0, 14) = 1 / std::sqrt(1e9);
  qp.b()[0] = 0.2 * random->Normal();
  return qp;
}

TEST(QpSolver, MeetsTheOptimalityConditions) {
  RandomStream random(1, "qp");
  QpSolver solver(kN, kM);
  QpSolution solution;
  double worst = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Qp qp = RandomQp(&random, 1e5, i % 2 ? 1e-5 : 1e-2, std::pow(10, -3 + 4 * random.Uniform()));
    solver.Solve(qp, &solution);
    ASSERT_TRUE(solution.solved) << i;
    worst = std::max(worst, KktResidual(qp, solution));
  }
  EXPECT_LT(worst, 1e-6);
  RecordProperty("worst_kkt_residual", std::to_string(worst));
}

TEST(QpSolver, AgreesWithAnotherSolver) {
  RandomStream random(2, "qp");
  QpSolver solver(kN, kM);
  QpSolution solution;
  eiquadprog::solvers::EiquadprogFast other;
  other.reset(kN, 0, 2 * 14 + kM);
  for (int i = 0; i < 500; ++i) {
    const Qp qp = RandomQp(&random, 100, 1e-2, 0.3);
    solver.Solve(qp, &solution);
    ASSERT_TRUE(solution.solved);
    // CI x + ci0 ≥ 0
    Eigen::MatrixXd CI = Eigen::MatrixXd::Zero(2 * 14 + kM, kN);
    Eigen::VectorXd ci0(2 * 14 + kM);
    for (int j = 0; j < 14; ++j) {
      CI(2 * j, j) = 1, ci0[2 * j] = -qp.lower()[j];
      CI(2 * j + 1, j) = -1, ci0[2 * j + 1] = qp.upper()[j];
    }
    CI.bottomRows(kM) = qp.A();
    ci0.tail(kM) = -qp.b();
    Eigen::VectorXd x(kN);
    const auto status = other.solve_quadprog(qp.H(), qp.f(), Eigen::MatrixXd(0, kN), Eigen::VectorXd(0), CI, ci0, x);
    ASSERT_EQ(status, eiquadprog::solvers::EIQUADPROG_FAST_OPTIMAL);
    EXPECT_LT((x - Eigen::Map<Eigen::VectorXd>(solution.x.data(), kN)).lpNorm<Eigen::Infinity>(), 1e-6);
  }
}

// The checker itself must see every way of being wrong.
TEST(KktResidual, SeesWrongSolutions) {
  RandomStream random(3, "qp");
  QpSolver solver(kN, kM);
  QpSolution solution;
  int at_bound = 0;
  for (int i = 0; i < 200; ++i) {
    const Qp qp = RandomQp(&random, 100, 1e-2, 0.1);
    solver.Solve(qp, &solution);
    ASSERT_LT(KktResidual(qp, solution), 1e-6);
    QpSolution moved = solution;
    moved.x[3] += 1e-3;
    EXPECT_GT(KktResidual(qp, moved), 1e-6);
    for (std::size_t j = 0; j < 14; ++j) {
      if (std::abs(solution.multiplier[j]) < 1e-3) continue;
      ++at_bound;
      QpSolution flipped = solution;
      flipped.multiplier[j] = -flipped.multiplier[j];
      EXPECT_GT(KktResidual(qp, flipped), 1e-6);
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
    for (std::size_t j = 0; j < kN; ++j) EXPECT_EQ(a.x[j], b.x[j]);
  }
}

}  // namespace
}  // namespace predictor
