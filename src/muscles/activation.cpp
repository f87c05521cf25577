#include "muscles/activation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace predictor::muscles {
namespace {

constexpr int kMaxIterations = 200;
constexpr double kTolerance = 1e-10;  // tolerance of the slope, relative to the largest torque

// The negated value of the dual function at one λ, which is minimised.
struct Dual {
  double value = 0;
  ArmVector slope;
  MuscleVector activation;
  MuscleVector gain;  // derivative of the activation with respect to Bᵀλ; 0 at a bound
};

double CostOf(const ActivationProblem& p, int i, double a) {
  const double effort = a * a / 2;
  const double miss = a - p.measured[i];
  return p.weight[i] * effort + p.trust[i] * miss * miss / 2;
}

// Returns the activation at which the marginal cost equals `gain`, and the activation's derivative
// with respect to `gain`.
double ActivationAt(const ActivationProblem& p, int i, double gain, double* slope) {
  const double pulled = gain + p.trust[i] * p.measured[i];
  // `v` is twice the coefficient of the squared activation in the cost.
  const double v = p.trust[i] + p.weight[i];
  *slope = 1 / v;
  return pulled / v;
}

// `reserve_scale` is r²/c.
Dual DualAt(const ActivationProblem& p, const ArmVector& reserve_scale, const ArmVector& lambda) {
  Dual dual;
  const MuscleVector gains = p.torque.transpose() * lambda;
  const ArmVector reserve = reserve_scale.cwiseProduct(lambda);
  dual.value = lambda.dot(reserve) / 2 - lambda.dot(p.target);
  for (int i = 0; i < kMuscles; ++i) {
    double slope = 0;
    const double free = ActivationAt(p, i, gains[i], &slope);
    const double a = std::clamp(free, p.lower[i], p.upper[i]);
    const bool bound = free < p.lower[i] || free > p.upper[i];
    dual.activation[i] = a;
    dual.gain[i] = bound ? 0 : slope;
    dual.value += gains[i] * a - CostOf(p, i, a);
  }
  dual.slope = p.torque * dual.activation + reserve - p.target;
  return dual;
}

// Runs Newton's method from result->multiplier.
void Minimise(const ActivationProblem& problem, ActivationResult* result) {
  const ArmVector reserve_scale = problem.reserve_unit.cwiseAbs2() / problem.reserve_cost;
  const double small = kTolerance * std::max(1.0, problem.target.cwiseAbs().maxCoeff());
  ArmVector& lambda = result->multiplier;
  Dual dual = DualAt(problem, reserve_scale, lambda);
  for (int n = 0; n < kMaxIterations; ++n) {
    result->residual = dual.slope.cwiseAbs().maxCoeff();
    result->converged = result->residual <= small;
    if (result->converged) break;
    ++result->iterations;
    ArmMatrix H = reserve_scale.asDiagonal();
    for (int i = 0; i < kMuscles; ++i)
      if (dual.gain[i] > 0)
        H.noalias() += dual.gain[i] * problem.torque.col(i) * problem.torque.col(i).transpose();
    const ArmVector step = -Eigen::LLT<ArmMatrix>(H).solve(dual.slope);
    const double descent = dual.slope.dot(step);
    constexpr double kMinShare = 1e-4;  // required share of the decrease that the slope predicts
    const double rounding = 1e-14 * (1 + std::abs(dual.value));
    double share = 1;
    Dual next = DualAt(problem, reserve_scale, lambda + step);
    while (share > 1e-10 && next.value > dual.value + kMinShare * share * descent + rounding) {
      share /= 2;
      next = DualAt(problem, reserve_scale, lambda + share * step);
    }
    lambda += share * step;
    dual = next;
  }
  result->activation = dual.activation;
  result->reserve = reserve_scale.cwiseProduct(lambda);
}

}  // namespace

ActivationResult Activate(const ActivationProblem& problem) noexcept {
  ActivationResult result;
  result.multiplier.setZero();
  Minimise(problem, &result);
  result.cost =
      problem.reserve_cost / 2 * result.reserve.cwiseQuotient(problem.reserve_unit).squaredNorm();
  for (int i = 0; i < kMuscles; ++i) result.cost += CostOf(problem, i, result.activation[i]);
  return result;
}

}  // namespace predictor::muscles
