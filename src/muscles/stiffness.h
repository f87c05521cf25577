// Computes the stiffness of the arm's joints and of the hand from the forces of the muscles.
#pragma once

#include <optional>

#include "muscles/activation.h"

namespace predictor::muscles {

// The factor in a muscle's stiffness along its path, k = 23 F / l0, where l0 is the optimal fibre
// length. The factor is that of the short-range stiffness of active fibres (Rack & Westbury 1974,
// Cui et al. 2008, R). The tendon is assumed to be rigid, so k is too large for muscles with a long
// tendon.
inline constexpr double kShortRangeStiffness = 23;

// Returns K = -∂τ/∂q [N·m/rad] at constant activations: Rᵀ diag(k) R - (∂Rᵀ/∂q) F, where R is the
// matrix of moment arms with one row for each muscle. Only `active_force` [N] contributes to the
// stiffness k, while all of `force` [N] contributes to the term with ∂Rᵀ/∂q. The derivative ∂Rᵀ/∂q
// is computed by a central difference of the moment arms.
ArmMatrix JointStiffness(const ArmModel& arm, const ArmVector& q, const MuscleVector& active_force,
                         const MuscleVector& force) noexcept;

// A point of the hand for a given posture of the whole body.
struct HandPoint {
  // The Jacobian that maps the velocities of the arm's joints to the twist of the frame at the
  // point.
  Eigen::Matrix<double, 6, person::kArmJoints> J;
  // ∂(JᵀF)/∂q for the force F on the hand [N·m/rad].
  ArmMatrix turning;
};
// `p` [m] and `force` [N] are in the axes of the placement.
HandPoint HandPointAt(const person::BodyModel& body, const person::Placement& at, int hand,
                      const Vector3& p, const Vector3& force) noexcept;

// Returns the stiffness [N/m] of the hand's point for small displacements without rotation, as if
// the hand held a handle that keeps its orientation. This stiffness is the translational block of
// (J (K - ∂(JᵀF)/∂q)⁻¹ Jᵀ)⁻¹. The weight of the arm and the moment on the hand are neglected.
// Returns no value if the posture is not stable, or if the arm cannot move the hand in all
// directions.
std::optional<Matrix3> EndpointStiffness(const ArmMatrix& joint_stiffness,
                                         const HandPoint& point) noexcept;

// Returns the principal stiffnesses in ascending order [N/m].
Vector3 PrincipalStiffness(const Matrix3& stiffness) noexcept;

}  // namespace predictor::muscles
