#include "muscles/stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace predictor::muscles {

ArmMatrix JointStiffness(const ArmModel& arm, const ArmVector& q, const MuscleVector& active_force,
                         const MuscleVector& force) noexcept {
  constexpr double kStep = 1e-4;  // [rad]
  ArmMatrix K = ArmMatrix::Zero();
  const MomentArms R = arm.LinesAt(q).moment_arm;
  for (int i = 0; i < kMuscles; ++i) {
    const double k = kShortRangeStiffness * active_force[i] / arm.muscle(i).fibre_length;
    K.noalias() += k * R.col(i) * R.col(i).transpose();
  }
  for (int j = 0; j < person::kArmJoints; ++j) {
    const ArmVector step = kStep * ArmVector::Unit(j);
    K.col(j) -=
        (arm.LinesAt(q + step).moment_arm - arm.LinesAt(q - step).moment_arm) * force / (2 * kStep);
  }
  // Second derivatives commute, so any asymmetry of the matrix is due to rounding.
  return (K + K.transpose()) / 2;
}

HandPoint HandPointAt(const person::BodyModel& body, const person::Placement& at, int hand,
                      const Vector3& p, const Vector3& force) noexcept {
  const int first = person::Of(hand, person::ArmJoint::kShoulderFlexion);
  const int last = first + person::kArmJoints - 1;
  HandPoint point;
  point.J = person::JacobianAt(body, at, last, p).middleCols<person::kArmJoints>(first);
  for (int i = 0; i < person::kArmJoints; ++i)
    for (int j = 0; j <= i; ++j) {
      // The inner joint rotates the axis and the lever arm of the outer joint.
      const Vector3& inner = at.axis[static_cast<std::size_t>(first + j)];
      const Vector3 lever = point.J.col(i).head<3>();
      point.turning(i, j) = point.turning(j, i) = inner.cross(lever).dot(force);
    }
  return point;
}

std::optional<Matrix3> EndpointStiffness(const ArmMatrix& joint_stiffness,
                                         const HandPoint& point) noexcept {
  const ArmMatrix K = joint_stiffness - point.turning;
  const Eigen::LLT<ArmMatrix> factor(K);
  if (factor.info() != Eigen::Success) return {};
  const Matrix6 compliance = point.J * factor.solve(point.J.transpose());
  const Eigen::LLT<Matrix6> inverse((compliance + compliance.transpose()) / 2);
  if (inverse.info() != Eigen::Success) return {};
  const Matrix6 stiffness = inverse.solve(Matrix6::Identity());
  const Matrix3 block = stiffness.topLeftCorner<3, 3>();
  return (block + block.transpose()) / 2;
}

Vector3 PrincipalStiffness(const Matrix3& stiffness) noexcept {
  return Eigen::SelfAdjointEigenSolver<Matrix3>(stiffness, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace predictor::muscles
