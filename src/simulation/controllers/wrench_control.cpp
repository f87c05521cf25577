#include "simulation/controllers/wrench_control.h"

namespace predictor::controllers {

void WrenchControl::Compute(const ControllerInput& input, JointVector* torque) noexcept {
  const Pose X = input.data->FramePose(*input.model, input.end_effector);
  const Twist V = input.data->FrameTwist(*input.model, input.end_effector);
  Wrench F = Command(input, X, V);
  F.head<3>() -= p_.damping_translation * V.head<3>();
  F.tail<3>() += p_.stiffness_rotation * RotationError(X_start_.q, X.q);
  F.tail<3>() -= p_.damping_rotation * V.tail<3>();
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  *torque = input.data->gravity();
  torque->noalias() += J_.transpose().lazyProduct(F);
}

double WrenchControl::StoredEnergy(const ControllerInput& input) const noexcept {
  const Pose X = input.data->FramePose(*input.model, input.end_effector);
  return 0.5 * p_.stiffness_rotation * RotationError(X_start_.q, X.q).squaredNorm() + Potential(X);
}

}  // namespace predictor::controllers
