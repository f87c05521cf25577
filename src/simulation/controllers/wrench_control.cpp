#include "simulation/controllers/wrench_control.h"

#include "simulation/controllers/set_point.h"

namespace predictor::controllers {

Vector6 WrenchControl::set_point_axes() const noexcept {
  return StiffAxes(
      (Vector6() << Vector3::Zero(), Vector3::Constant(p_.stiffness_rotation)).finished());
}

FrameMotion WrenchControl::Target(double time) const noexcept {
  FrameMotion target = SetPoint(time);
  ShiftPose(jump_, &target.X_W);
  return target;
}

void WrenchControl::Compute(const ControllerInput& input, JointVector* torque) noexcept {
  const Pose X = input.data->FramePose(*input.model, input.end_effector);
  const Twist V = input.data->FrameTwist(*input.model, input.end_effector);
  const FrameMotion d = Target(input.time);
  Wrench F = Command(d.X_W, X, V);
  F.head<3>() -= p_.damping_translation * (V - d.V_W).head<3>();
  F.tail<3>() += p_.stiffness_rotation * RotationError(d.X_W.q, X.q);
  F.tail<3>() -= p_.damping_rotation * (V - d.V_W).tail<3>();
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  *torque = input.data->gravity();
  torque->noalias() += J_.transpose().lazyProduct(F);
}

double WrenchControl::StoredEnergy(const ControllerInput& input) const noexcept {
  const Pose X = input.data->FramePose(*input.model, input.end_effector);
  const Pose X_d = Target(input.time).X_W;
  return 0.5 * p_.stiffness_rotation * RotationError(X_d.q, X.q).squaredNorm() + Potential(X, X_d);
}

}  // namespace predictor::controllers
