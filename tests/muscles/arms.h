// The arms, postures and problems of the tests.
#pragma once

#include <numbers>
#include <stdexcept>
#include <string>

#include "core/random.h"
#include "muscles/activation.h"

namespace predictor::muscles {

inline constexpr double kPi = std::numbers::pi;
inline double Radians(double degrees) { return degrees * kPi / 180; }

inline int IndexOf(const std::string& key) {
  for (int i = 0; i < kMuscles; ++i)
    if (key == MuscleTable()[static_cast<std::size_t>(i)].key) return i;
  throw std::out_of_range(key);
}

// Draws a random posture within the middle `share` of the joints' ranges, with a shoulder flexion
// of at most 90°.
inline ArmVector RandomArm(const ArmModel& arm, RandomStream* random, double share = 0.8) {
  ArmVector q;
  for (int i = 0; i < person::kArmJoints; ++i) {
    const person::BodyJoint& joint =
        arm.body().joint(person::Of(arm.hand(), static_cast<person::ArmJoint>(i)));
    const double upper = i == 0 ? kPi / 2 : joint.upper;
    q[i] = (joint.lower + upper) / 2 + share * (upper - joint.lower) * (random->Uniform() - 0.5);
  }
  return q;
}

// The upper arm points a little forward and outward, and the elbow is at a right angle.
inline ArmVector WorkPosture() {
  ArmVector q = ArmVector::Zero();
  q[0] = Radians(30);
  q[1] = Radians(15);
  q[3] = Radians(90);
  return q;
}

// Returns the problem of an arm at rest in posture q that must produce `torque` [N·m].
inline ActivationProblem ProblemAt(const ArmModel& arm, const ArmVector& q,
                                   const ArmVector& torque) {
  const MuscleLines lines = arm.LinesAt(q);
  const MuscleForces forces = arm.ForcesAt(lines, ArmVector::Zero());
  ActivationProblem problem;
  problem.torque = lines.moment_arm * forces.active.asDiagonal();
  problem.target = torque - lines.moment_arm * forces.passive;
  return problem;
}

}  // namespace predictor::muscles
