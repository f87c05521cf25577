// Computes the limits of the simulated operator's motions and forces from what an arm can do in the
// present posture.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "core/types.h"

namespace predictor {

// Returns the largest share of a load, from 0 to 1, for which at_rest + share · load is between
// lower and upper. If at_rest is outside this range, returns 1 if the load moves the value back
// towards the range, and returns 0 otherwise.
inline double LargestShare(double at_rest, double load, double lower, double upper) {
  if (load == 0) return 1;
  return std::clamp(((load > 0 ? upper : lower) - at_rest) / load, 0.0, 1.0);
}

// The muscle torque of a joint is at_rest + per_force · F for a force F of the hand on the handle
// [N]. This torque is limited by the person's strength in both directions.
struct JointAbility {
  double at_rest = 0;                   // torque that carries the arm [N·m]
  Vector3 per_force = Vector3::Zero();  // [m]
  double lower = 0, upper = 0;          // [N·m], lower ≤ 0 ≤ upper

  double TorqueFor(const Vector3& F) const { return at_rest + per_force.dot(F); }
  template <class A>
  void Archive(A& a) {
    a(at_rest, per_force, lower, upper);
  }
};
inline constexpr int kJudgedJoints = 2;  // elbow and shoulder flexion

// In W.
struct ArmAbility {
  Matrix3 stiffness = Matrix3::Zero();  // stiffness of the hand, including reflexes [N/m]
  Vector3 shoulder = Vector3::Zero();   // [m]
  std::array<JointAbility, kJudgedJoints> joints;
  double capacity = 1;  // share of strength left after fatigue, for the weaker joint

  template <class A>
  void Archive(A& a) {
    a(stiffness, shoulder, joints, capacity);
  }
};

// Returns the share of the force for which the joints are strong enough.
inline double StrengthShare(const ArmAbility& arm, const Vector3& F) {
  double share = 1;
  for (const JointAbility& joint : arm.joints)
    share = std::min(share,
                     LargestShare(joint.at_rest, joint.per_force.dot(F), joint.lower, joint.upper));
  return share;
}

// Returns the point nearest to p whose distance from the shoulder is between `shortest` and
// `longest` [m].
inline Vector3 WithinReach(const Vector3& p, const Vector3& shoulder, double shortest,
                           double longest) {
  const Vector3 arm = p - shoulder;
  const double length = arm.norm();
  // If p is within reach, the result is exactly p, because callers compare the result with p.
  if ((length >= shortest && length <= longest) || !(length > 1e-9)) return p;
  return shoulder + arm * (std::clamp(length, shortest, longest) / length);
}

// The weight and the feet, in S, of a person who stands still and holds nothing.
struct Standing {
  double weight = 0;           // [N]
  double x = 0, y = 0;         // position of the centre of mass [m]
  double back = 0, front = 0;  // edges of the footprint along x [m]
  double half_width = 0;       // half of its width along y [m]

  template <class A>
  void Archive(A& a) {
    a(weight, x, y, back, front, half_width);
  }
};
// The force of a hand on its handle and the point p at which the force acts, both in S.
struct HandForce {
  Vector3 p = Vector3::Zero(), F = Vector3::Zero();
};
// The largest shares of the forces' x and y components for which the centre of pressure stays
// within the footprint. In the static case, the normal force is N = W + Σ Fz. This force acts at c
// = (x W + Σ (px Fz - pz Fx)) / N along x, and similarly along y. A force along y does not move the
// centre of pressure along x, so a person who stands at the front edge of the feet can still push
// sideways.
struct BalanceShares {
  double x = 1, y = 1;
};
BalanceShares BalanceSharesOf(const Standing& person, std::span<const HandForce> forces);

}  // namespace predictor
