#include "rig/arm_stiffness.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kStraight = 1e-6;  // sine of the elbow angle below which an arm counts as straight

// Returns V f(d) Vᵀ of a symmetric matrix with the eigenvectors V and the eigenvalues d.
template <class F>
Matrix3 OfEigenvalues(const Matrix3& symmetric, F f) {
  Eigen::SelfAdjointEigenSolver<Matrix3> solver;
  solver.computeDirect(symmetric);
  Vector3 values;
  for (int i = 0; i < 3; ++i) values[i] = f(solver.eigenvalues()[i]);
  const Matrix3& V = solver.eigenvectors();
  return V * values.asDiagonal() * V.transpose();
}

// Returns ∂Jᵀ/∂q F, the second derivatives of the hand's position along F. The lateral joint is the
// first joint of the chain, so it also rotates the axes of the other two.
Matrix3 Bending(const ArmPoints& arm, const ArmAxes& axes, const Matrix3& J, const Vector3& F) {
  const Vector3 upper = arm.hand - arm.shoulder, fore = arm.hand - arm.elbow;
  const auto across = [&](int joint) { return axes.lateral.cross(J.col(joint)).dot(F); };
  Matrix3 H;
  H(0, 0) = -upper.dot(F);
  H(0, 1) = H(1, 0) = across(1);
  H(0, 2) = H(2, 0) = across(2);
  H(1, 1) = -upper.dot(F);
  H(1, 2) = H(2, 1) = H(2, 2) = -fore.dot(F);
  return H;
}

}  // namespace

ArmAxes AxesOf(const ArmPoints& arm) {
  const Vector3 line = arm.hand - arm.shoulder;
  const Vector3 upper_arm = arm.elbow - arm.shoulder;
  Vector3 normal = upper_arm.cross(line);
  if (!(normal.norm() > kStraight * upper_arm.norm() * line.norm())) normal = line.unitOrthogonal();
  normal.normalize();
  return {line.cross(normal).normalized(), normal};
}

Matrix3 HandJacobian(const ArmPoints& arm, const ArmAxes& axes) {
  Matrix3 J;
  J.col(0) = axes.lateral.cross(arm.hand - arm.shoulder);
  J.col(1) = axes.normal.cross(arm.hand - arm.shoulder);
  J.col(2) = axes.normal.cross(arm.hand - arm.elbow);
  return J;
}

Matrix3 JointStiffness(const Vector3& torque) {
  const Vector3 t = torque.cwiseAbs();
  Matrix3 K = Matrix3::Zero();
  K(0, 0) = 10.8 + 3.18 * t[0];
  K(1, 1) = 10.8 + 3.18 * t[1];
  K(1, 2) = K(2, 1) = ((2.83 + 2.15 * t[2]) + (2.51 + 2.34 * t[2])) / 2;
  K(2, 2) = 8.67 + 6.18 * t[2];
  return K;
}

Matrix3 HandStiffness(const ArmPoints& arm, const Matrix3& joint_stiffness, const Vector3& F) {
  const ArmAxes axes = AxesOf(arm);
  const Matrix3 J = HandJacobian(arm, axes);
  const Matrix3 K = joint_stiffness - Bending(arm, axes, J, F);
  const Matrix3 joint_compliance = OfEigenvalues(
      (K + K.transpose()) / 2, [](double k) { return 1 / std::max(k, kMinJointStiffness); });
  return OfEigenvalues(J * joint_compliance * J.transpose(), [](double c) {
    return std::clamp(1 / std::max(c, 1e-9), kMinHandStiffness, kMaxHandStiffness);
  });
}

Matrix3 HandDamping(const Matrix3& stiffness, double mass, double damping_ratio) {
  return OfEigenvalues(
      stiffness, [&](double k) { return 2 * damping_ratio * std::sqrt(mass * std::max(k, 0.0)); });
}

}  // namespace predictor
