#include "simulation/controllers/admittance_law.h"

#include <algorithm>
#include <numbers>

#include "simulation/damped_inverse.h"

namespace predictor::controllers {
namespace {

constexpr double kPostureRate = 0.5;  // return to the posture in the null space [1/s]

}  // namespace

Vector6 AdmittanceParameters::Mass() const noexcept {
  return (Vector6() << Vector3::Constant(mass), Vector3::Constant(inertia)).finished();
}

Vector6 AdmittanceParameters::Damping() const noexcept {
  return (Vector6() << Vector3::Constant(damping_translation), Vector3::Constant(damping_rotation))
      .finished();
}

AdmittanceLaw::AdmittanceLaw(const ControllerContext& context,
                             const AdmittanceParameters& parameters, int own)
    : posture_(context.posture),
      mass_(parameters.Mass()),
      omega_(2 * std::numbers::pi * parameters.inner_frequency),
      memory_(static_cast<std::size_t>(kReference + context.posture.size() + own)) {
  Reference() = posture_;
}

void AdmittanceLaw::Start(const ControllerInput& input) noexcept {
  tare_ = input.F_E_W;
  std::fill(memory_.begin(), memory_.end(), 0.0);
  Reference() = posture_;
}

// With V = 0, x = x_d and a slow return to the posture, the law becomes τ − g = M (ω² (q_ref − q) −
// 2 ω q̇).
void AdmittanceLaw::TakeOver(const ControllerInput& input) noexcept {
  std::fill(memory_.begin(), memory_.end(), 0.0);
  Vector6::Map(memory_.data() + kDisplacement) = PathAt(input.time);
  M_factor_.compute(input.data->M());
  const JointVector acceleration = M_factor_.solve(*input.torque - input.data->gravity());
  Reference() = *input.q + (acceleration + 2 * omega_ * *input.v) / (omega_ * omega_);
}

void AdmittanceLaw::Advance(const ControllerInput& input, double dt) noexcept {
  const Wrench F = input.F_E_W - tare_;
  const Vector6 before = V();
  const Vector6 rate = Accelerating(input, F).cwiseQuotient(mass_);
  const JointVector speed = ReferenceSpeed(input);
  AdvanceOwn(input, F, dt);
  Vector6::Map(memory_.data()) += dt * rate;
  Vector6::Map(memory_.data() + kDisplacement) += dt * before;
  Reference() += dt * speed;
}

void AdmittanceLaw::Compute(const ControllerInput& input, JointVector* torque) noexcept {
  const JointVector speed = ReferenceSpeed(input);
  const JointVector wanted =
      omega_ * omega_ * (Reference() - *input.q) + 2 * omega_ * (speed - *input.v);
  *torque = input.data->gravity();
  torque->noalias() += input.data->M().lazyProduct(wanted);
}

// Returns q̇_ref = J⁺ V + (1 − J⁺ J) (posture − q_ref) / time.
JointVector AdmittanceLaw::ReferenceSpeed(const ControllerInput& input) noexcept {
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  FactorDamped(J_, &factor_);
  const JointVector home = kPostureRate * (posture_ - Reference());
  const Vector6 twist = V() - J_.lazyProduct(home);
  return home + J_.transpose().lazyProduct(factor_.solve(twist));
}

}  // namespace predictor::controllers
