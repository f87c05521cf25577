#include "muscles/activation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "muscles/arms.h"
#include "muscles/general_solver.h"
#include "support/allocation_guard.h"

namespace predictor::muscles {
namespace {

// Two muscles flex the elbow, with torques of 30 and 10 N·m at full activation.
ActivationProblem TwoMuscles(double torque) {
  ActivationProblem problem;
  problem.torque(3, 0) = 30;
  problem.torque(3, 1) = 10;
  problem.target[3] = torque;
  problem.reserve_unit.setConstant(1e-4);  // negligible
  return problem;
}

// The activations must be in proportion to the torques of the muscles: a_i = b_i τ / Σ b².
TEST(Activation, TwoMusclesShareByTheirTorque) {
  const ActivationResult result = Activate(TwoMuscles(20));
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.activation[0], 30 * 20 / 1000.0, 1e-6);
  EXPECT_NEAR(result.activation[1], 10 * 20 / 1000.0, 1e-6);
  EXPECT_NEAR(result.cost, 20 * 20 / 1000.0 / 2, 1e-6);
}

// The stronger muscle reaches its bound, and the other one produces the rest.
TEST(Activation, TheRestOfASaturatedMuscleGoesToTheOther) {
  const ActivationResult result = Activate(TwoMuscles(36));
  ASSERT_TRUE(result.converged);
  EXPECT_EQ(result.activation[0], 1);
  EXPECT_NEAR(result.activation[1], 0.6, 1e-6);
}

TEST(Activation, AnOpposingMuscleRests) {
  ActivationProblem problem = TwoMuscles(9);
  problem.torque(3, 1) = -10;
  const ActivationResult result = Activate(problem);
  EXPECT_NEAR(result.activation[0], 0.3, 1e-6);
  EXPECT_EQ(result.activation[1], 0);
}

// If the opposing muscle has a lower bound, the other muscle must produce just as much additional
// torque.
TEST(Activation, CoContractionIsBalanced) {
  ActivationProblem problem = TwoMuscles(9);
  problem.torque(3, 1) = -10;
  problem.lower[1] = 0.3;
  const ActivationResult result = Activate(problem);
  EXPECT_EQ(result.activation[1], 0.3);
  EXPECT_NEAR(result.activation[0], (9 + 3) / 30.0, 1e-6);
}

TEST(Activation, WhatTheMusclesCannotProduceIsInTheReserve) {
  ActivationProblem problem = TwoMuscles(55);
  problem.reserve_unit.setOnes();
  const ActivationResult result = Activate(problem);
  ASSERT_TRUE(result.converged);
  EXPECT_EQ(result.activation[0], 1);
  EXPECT_EQ(result.activation[1], 1);
  EXPECT_NEAR(result.reserve[3], 15, 1e-9);
  EXPECT_NEAR(result.reserve[0], 0, 1e-12);
}

// If the task requires no force of a muscle, min a²/2 + v (a - e)²/2 has the solution a = v e / (1
// + v).
TEST(Activation, MeasuredActivationsPull) {
  ActivationProblem problem;
  problem.measured[5] = 0.6;
  problem.trust[5] = 2;
  const ActivationResult result = Activate(problem);
  EXPECT_NEAR(result.activation[5], 2 * 0.6 / 3, 1e-12);
  // Even if the activation of an opposing muscle was measured, the muscles must produce the
  // required torque.
  ActivationProblem pair = TwoMuscles(9);
  pair.torque(3, 1) = -10;
  pair.measured[1] = 0.5;
  pair.trust[1] = 1e6;
  const ActivationResult both = Activate(pair);
  EXPECT_NEAR(both.activation[1], 0.5, 1e-4);
  EXPECT_NEAR(30 * both.activation[0] - 10 * both.activation[1], 9, 1e-6);
}

// Returns a random problem of an arm that demands a random share of its strength.
ActivationProblem RandomProblem(const ArmModel& arm, RandomStream* random) {
  const ArmVector q = RandomArm(arm, random);
  ArmVector torque;
  const double scale = 40 * random->Uniform();
  for (int i = 0; i < person::kArmJoints; ++i)
    torque[i] = (i < 4 ? 1 : 0.15) * scale * random->Normal();
  ActivationProblem problem = ProblemAt(arm, q, torque);
  for (int i = 0; i < kMuscles; ++i) problem.weight[i] = 0.2 + random->Uniform();
  return problem;
}

// Evaluates stationarity, complementarity and balance independently of the solver's code.
double KktViolation(const ActivationProblem& p, const ActivationResult& r) {
  double worst = (p.torque * r.activation + r.reserve - p.target).cwiseAbs().maxCoeff();
  worst = std::max(
      worst, (p.reserve_cost * r.reserve.cwiseQuotient(p.reserve_unit.cwiseAbs2()) - r.multiplier)
                 .cwiseAbs()
                 .maxCoeff());
  for (int i = 0; i < kMuscles; ++i) {
    const double a = r.activation[i];
    const double slope =
        p.weight[i] * a + p.trust[i] * (a - p.measured[i]) - p.torque.col(i).dot(r.multiplier);
    worst = std::max({worst, p.lower[i] - a, a - p.upper[i]});
    if (a > p.lower[i] + 1e-12)
      worst = std::max(worst, slope);  // a smaller activation would reduce the cost
    if (a < p.upper[i] - 1e-12)
      worst = std::max(worst, -slope);  // a larger activation would reduce the cost
  }
  return worst;
}

TEST(Activation, MeetsTheOptimalityConditions) {
  const ArmModel arm({}, 1);
  RandomStream random(7, "optimality");
  int iterations = 0, saturated = 0;
  for (int n = 0; n < 2000; ++n) {
    ActivationProblem problem = RandomProblem(arm, &random);
    if (n % 5 == 0) {
      problem.lower.setConstant(0.05);
      for (int i = 0; i < kMuscles; ++i) {
        problem.measured[i] = random.Uniform();
        problem.trust[i] = random.Uniform();
      }
    }
    const ActivationResult result = Activate(problem);
    ASSERT_TRUE(result.converged) << n << ": " << result.residual << " N·m after "
                                  << result.iterations;
    ASSERT_LT(KktViolation(problem, result), 1e-6) << n;
    iterations += result.iterations;
    saturated += result.activation.maxCoeff() >= 1 ? 1 : 0;
  }
  EXPECT_GT(saturated, 100);  // proves that hard problems occur
  std::printf("%.1f iterations on average, %d of 2000 saturated\n", iterations / 2000.0, saturated);
}

TEST(Activation, AgreesWithAGeneralSolver) {
  const ArmModel arm({}, 0);
  RandomStream random(11, "general solver");
  GeneralSolver general;
  double worst = 0;
  for (int n = 0; n < 1000; ++n) {
    const ActivationProblem problem = RandomProblem(arm, &random);
    const ActivationResult result = Activate(problem);
    const double cost = general.CostOf(problem);
    ASSERT_TRUE(std::isfinite(cost)) << n;
    worst = std::max(worst, std::abs(cost - result.cost) / std::max(1.0, cost));
    ASSERT_NEAR(result.cost, cost, 2e-5 * std::max(1.0, cost)) << n;
  }
  std::printf("largest relative difference of the cost: %.1e\n", worst);
}

TEST(Activation, IsDeterministicAndDoesNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  const ArmModel arm({}, 1);
  RandomStream random(3, "allocation");
  const ArmVector q = RandomArm(arm, &random);
  const ActivationProblem problem = ProblemAt(arm, q, ArmVector::Constant(3));
  const ActivationResult first = Activate(problem);
  ActivationResult second;
  {
    const test::AllocationGuard guard;
    const MuscleLines lines = arm.LinesAt(q);
    const MuscleForces forces = arm.ForcesAt(lines, q);
    second = Activate(problem);
    EXPECT_EQ(guard.count(), 0) << forces.active[0];
  }
  EXPECT_EQ(first.activation, second.activation);
}

}  // namespace
}  // namespace predictor::muscles
