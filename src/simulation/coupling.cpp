#include "simulation/coupling.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace predictor {
namespace {

constexpr double kMaxStepGain = 0.3;     // d·dt·mobility of a damper
constexpr double kRotationLength = 0.2;  // converts speed_damping into rotational damping [m]

// Returns `damping` [N·s/m or N·m·s/rad], reduced if necessary so that a step of dt [s] is stable.
double Limited(double damping, double mobility, double dt) {
  return std::min(damping, kMaxStepGain / (mobility * dt));
}

}  // namespace

HandleMobility MobilityAt(double mass, const Matrix3& inertia, const Vector3& lever) {
  const Matrix3 inverse = inertia.inverse();
  const Matrix3 S = Skew(lever);
  const Matrix3 turning = S * inverse * S.transpose();
  const auto largest = [](const Matrix3& a) {
    return Eigen::SelfAdjointEigenSolver<Matrix3>(a, Eigen::EigenvaluesOnly).eigenvalues()[2];
  };
  return {1 / mass + largest(turning), largest(inverse)};
}

Coupling::Coupling(const CouplingSpec& spec, double speed_cap, double rotation_speed_cap,
                   const HandleMobility& mobility, double dt) {
  const double u = mobility.translation;
  const double w = mobility.rotation;
  translation_ = {spec.deadband, spec.stiffness, Limited(spec.damping, u, dt), speed_cap,
                  Limited(spec.speed_damping, u, dt)};
  rotation_ = {spec.rotation_deadband, spec.rotation_stiffness,
               Limited(spec.rotation_damping, w, dt), rotation_speed_cap,
               Limited(spec.speed_damping * kRotationLength * kRotationLength, w, dt)};
}

Vector3 Coupling::Part::Compute(const Vector3& error, const Vector3& v_D,
                                const Vector3& v_H) const noexcept {
  Vector3 force = Vector3::Zero();
  const double distance = error.norm();
  if (distance > deadband) {
    const double beyond = distance - deadband;
    const double share = deadband > 0 ? std::min(beyond / deadband, 1.0) : 1.0;
    force = (stiffness * beyond / distance) * error + share * damping * (v_H - v_D);
  }
  const double speed = v_D.norm();
  if (speed > speed_cap) force -= (speed_damping * (1 - speed_cap / speed)) * v_D;
  return force;
}

Wrench Coupling::Compute(const FrameMotion& D, const FrameMotion& H) const noexcept {
  const Vector6 error = PoseError(H.X_W, D.X_W);
  Wrench wrench;
  wrench.head<3>() = translation_.Compute(error.head<3>(), D.V_W.head<3>(), H.V_W.head<3>());
  wrench.tail<3>() = rotation_.Compute(error.tail<3>(), D.V_W.tail<3>(), H.V_W.tail<3>());
  return wrench;
}

}  // namespace predictor
