// Static optimisation: which activations of the muscles produce given torques at the least cost.
#pragma once

#include "muscles/arm_model.h"

namespace predictor::muscles {

// min Σ w a^p / p + Σ v (a - e)² / 2 + c Σ (s / r)² / 2
// subject to B a + s = τ and lower ≤ a ≤ upper.
// The reserve s is what the muscles cannot produce: it makes every problem solvable, and is to be
// shown wherever activations are.
struct ActivationProblem {
  MomentArms torque = MomentArms::Zero();  // B: torques of each muscle at full activation [N·m]
  ArmVector target = ArmVector::Zero();    // τ: torques less those of the passive forces [N·m]
  MuscleVector lower = MuscleVector::Zero(), upper = MuscleVector::Ones();
  MuscleVector weight = MuscleVector::Ones();  // w > 0
  // 2: least sum of squares; 3 (Crowninshield & Brand 1981, R): spreads the load more evenly; for a
  // bounded slope, kSquareShare of the cost of p = 2 is added.
  int power = 2;
  // Measured activations e with weights v ≥ 0 (0: not measured).
  MuscleVector measured = MuscleVector::Zero(), trust = MuscleVector::Zero();
  ArmVector reserve_unit = ArmVector::Ones();  // r [N·m]
  double reserve_cost = 10;                    // c (D)
};

inline constexpr double kSquareShare = 0.01;  // (D)

struct ActivationResult {
  MuscleVector activation;
  ArmVector reserve;  // s [N·m]
  // λ [1/(N·m)]: by how much the cost rises with the target.
  ArmVector multiplier;
  double cost = 0;
  double residual = 0;  // largest violation of B a + s = τ [N·m]
  int iterations = 0;
  bool converged = false;
};

// Semismooth Newton on the dual, which has one unknown for each joint: a(λ) minimises the cost less
// λᵀ B a within the bounds, s = λ r² / c, and the slope of the strictly convex dual is
// B a(λ) + s(λ) - τ. A line search makes it converge from everywhere. Deterministic, no heap.
ActivationResult Activate(const ActivationProblem& problem) noexcept;

}  // namespace predictor::muscles
