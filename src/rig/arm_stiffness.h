// Computes the stiffness of the hand from the stiffness of the arm's joints and from the posture.
//
// Marks at the figures state their origin. V: checked against a copy. R: quoted from memory of the
// literature. D: our choice.
#pragma once

#include "core/types.h"

namespace predictor {

// The positions of the points of an arm, in any frame [m].
struct ArmPoints {
  Vector3 shoulder, elbow, hand;
};

// An arm as three joints that together move the hand in all directions. The shoulder and the elbow
// rotate about the normal of the plane through the three points. The lateral joint is the rotation
// of the shoulder about an axis in that plane, perpendicular to the line to the hand. A rotation
// about that line itself (the swivel) does not move the hand. The order of the rows and columns
// below is lateral, shoulder, elbow.
struct ArmAxes {
  Vector3 lateral, normal;  // unit vectors; of a straight arm, any normal
};
ArmAxes AxesOf(const ArmPoints& arm);
// Returns the Jacobian J with dx = J dq of the hand [m/rad].
Matrix3 HandJacobian(const ArmPoints& arm, const ArmAxes& axes);

// Returns K_J = -∂τ/∂q [N·m/rad] of muscles that produce the torques τ [N·m], in the order above.
// The values of shoulder and elbow are the symmetric part of the stiffness in Tee, Burdet, Chew &
// Milner, Biol. Cybern. 90 (2004) 368, after Gomi & Osu 1998 (R). The stiffness was measured in the
// horizontal plane with a supported arm, and includes reflexes. The lateral joint is assumed to be
// as stiff as the shoulder (D).
Matrix3 JointStiffness(const Vector3& torque);

// Returns the symmetric part of K_x = J⁻ᵀ (K_J - ∂Jᵀ/∂q F) J⁻¹ [N/m]. The function computes K_x as
// the inverse of the compliance J (K_J - ∂Jᵀ/∂q F)⁻¹ Jᵀ, so that a straight arm needs no special
// case. F is the force of the handle on the hand [N]. The joints' stiffness is at least
// kMinJointStiffness, and the eigenvalues of the hand's stiffness are limited to the range from
// kMinHandStiffness to kMaxHandStiffness. Measured values are from 50 to 600 N/m in relaxed arms
// and 1000 N/m in co-contracted arms (Mussa-Ivaldi 1985; Tsuji 1995; R).
Matrix3 HandStiffness(const ArmPoints& arm, const Matrix3& joint_stiffness, const Vector3& F);
inline constexpr double kMinJointStiffness = 1;                            // [N·m/rad] (D)
inline constexpr double kMinHandStiffness = 50, kMaxHandStiffness = 1000;  // [N/m]

// Returns D = 2 ζ √M √K [N·s/m] with matrix square roots, so that the damping ratio is ζ along each
// principal direction.
Matrix3 HandDamping(const Matrix3& stiffness, double mass, double damping_ratio);

}  // namespace predictor
