// Computes the muscle activations that produce given torques at the least cost (static
// optimisation).
#pragma once

#include "muscles/arm_model.h"

namespace predictor::muscles {

// Minimises Σ w a² / 2 + Σ v (a - e)² / 2 + c Σ (s / r)² / 2 subject to B a + s = τ and lower ≤ a
// ≤ upper. The reserve s is the part of the torques that the muscles cannot produce. The reserve
// makes every problem solvable, and must be shown wherever activations are shown.
struct ActivationProblem {
  MomentArms torque = MomentArms::Zero();  // B: torques of each muscle at full activation [N·m]
  ArmVector target = ArmVector::Zero();    // τ: torques minus those of the passive forces [N·m]
  MuscleVector lower = MuscleVector::Zero(), upper = MuscleVector::Ones();
  MuscleVector weight = MuscleVector::Ones();  // w > 0
  // Measured activations e with weights v ≥ 0 (0 if not measured).
  MuscleVector measured = MuscleVector::Zero(), trust = MuscleVector::Zero();
  ArmVector reserve_unit = ArmVector::Ones();  // r [N·m]
  double reserve_cost = 10;                    // c (D)
};

struct ActivationResult {
  MuscleVector activation;
  ArmVector reserve;  // s [N·m]
  // λ [1/(N·m)] is the derivative of the cost with respect to the target.
  ArmVector multiplier;
  double cost = 0;
  double residual = 0;  // largest violation of B a + s = τ [N·m]
  int iterations = 0;
  bool converged = false;
};

// Applies a semismooth Newton method to the dual problem, which has one unknown λ for each joint.
// The activations a(λ) minimise the cost minus λᵀ B a within the bounds, and s = λ r² / c. The
// slope of the strictly convex dual is B a(λ) + s(λ) - τ. With a line search, the method converges
// from any start. The method is deterministic and does not use the heap.
ActivationResult Activate(const ActivationProblem& problem) noexcept;

}  // namespace predictor::muscles
