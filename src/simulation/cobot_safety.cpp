#include "simulation/cobot_safety.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/damped_inverse.h"
#include "simulation/smooth_friction.h"

namespace predictor {
namespace {

constexpr double kHoldFrequency = 8;    // of the position loop in a protective stop [Hz]
constexpr double kSpeedCapTime = 0.01;  // time constant by which the speed cap brakes [s]

}  // namespace

CobotSafety::CobotSafety(const CobotSpec& spec)
    : spec_(spec.safety),
      friction_(spec.joint_friction),
      watches_(spec_.force || spec_.speed || spec_.momentum || spec_.joint_torque ||
               spec_.joint_force) {}

JointVector CobotSafety::Friction(const JointVector& v) const noexcept {
  JointVector torque = v;
  for (int j = 0; j < v.size(); ++j)
    torque[j] =
        SmoothFriction(OneOrEach(friction_.coulomb, j), OneOrEach(friction_.viscous, j), v[j]);
  return torque;
}

// Returns the wrench F on E with Jᵀ F ≈ torque.
Wrench CobotSafety::WrenchOf(const ControllerInput& input, const JointVector& torque) noexcept {
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  FactorDamped(J_, &factor_);
  return factor_.solve(J_.lazyProduct(torque));
}

void CobotSafety::Reset(const ControllerInput& input) noexcept {
  stop_ = CobotStop::kNone;
  v_before_ = *input.v;
  external_ = input.data->gravity() - *input.torque;
  F_E_W_ = WrenchOf(input, external_);
  payload_ = F_E_W_;
  load_ = 1;
  further_.setZero();
  q_stop_ = *input.q;
  v_stop_ = *input.v;
  fade_ = fade_rate_ = 0;
}

void CobotSafety::SetLoad(const ControllerInput& input, double share,
                          const Wrench& further) noexcept {
  if (share == load_ && further == further_) return;
  const Wrench change = (share - load_) * payload_ + further - further_;
  load_ = share;
  further_ = further;
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  external_.noalias() += J_.transpose().lazyProduct(change);
  F_E_W_ += change;
}

void CobotSafety::Watch(const ControllerInput& input, double dt) noexcept {
  if (!watches_) return;
  const double share = 1 - std::exp(-2 * std::numbers::pi * spec_.observer_rate * dt);
  JointVector seen = input.data->bias() + Friction(*input.v) - *input.torque;
  seen.noalias() += input.data->M().lazyProduct((*input.v - v_before_) / dt);
  external_ += share * (seen - external_);
  v_before_ = *input.v;
  F_E_W_ = WrenchOf(input, external_);
  if (stop_ != CobotStop::kNone) return;
  stop_ = Exceeded(input);
  if (stop_ == CobotStop::kNone) return;
  q_stop_ = *input.q;
  v_stop_ = *input.v;
  fade_ = 1;
  fade_rate_ = spec_.stop_deceleration / std::max(1e-9, v_stop_.lpNorm<Eigen::Infinity>());
}

CobotStop CobotSafety::Exceeded(const ControllerInput& input) noexcept {
  const Vector3 v = J_.topRows<3>().lazyProduct(*input.v);
  if (spec_.force && external_wrench().head<3>().norm() > *spec_.force) return CobotStop::kForce;
  if (spec_.speed && v.norm() > *spec_.speed) return CobotStop::kSpeed;
  if (spec_.momentum && v.norm() > 1e-6 &&
      v.norm() / Mobility(input, v.normalized()) > *spec_.momentum)
    return CobotStop::kMomentum;
  if (!spec_.joint_torque && !spec_.joint_force) return CobotStop::kNone;
  for (int j = 0; j < external_.size(); ++j) {
    const std::optional<double>& limit =
        input.model->is_prismatic(j) ? spec_.joint_force : spec_.joint_torque;
    if (limit && std::abs(external_[j] - J_.col(j).dot(load())) > *limit)
      return CobotStop::kJointTorque;
  }
  return CobotStop::kNone;
}

// Returns the inverse of the arm's effective mass at E along a direction [1/kg] (Khatib 1995).
double CobotSafety::Mobility(const ControllerInput& input, const Vector3& direction) noexcept {
  M_factor_.compute(input.data->M());
  const JointVector along = J_.topRows<3>().transpose().lazyProduct(direction);
  return std::max(1e-9, along.dot(JointVector(M_factor_.solve(along))));
}

void CobotSafety::Limit(const ControllerInput& input, double dt, JointVector* torque) noexcept {
  if (stop_ != CobotStop::kNone) return StopTorque(input, dt, torque);
  if (spec_.force_cap) CapForce(input, torque);
  if (spec_.speed_cap) CapSpeed(input, torque);
}

// The controller's force at E is the part of its torques that exceeds the arm's weight and the
// payload.
void CobotSafety::CapForce(const ControllerInput& input, JointVector* torque) noexcept {
  const Wrench F = WrenchOf(input, *torque - input.data->gravity()) + load();
  const double force = F.head<3>().norm();
  if (force <= *spec_.force_cap) return;
  Wrench excess = Wrench::Zero();
  excess.head<3>() = (1 - *spec_.force_cap / force) * F.head<3>();
  torque->noalias() -= J_.transpose().lazyProduct(excess);
}

void CobotSafety::CapSpeed(const ControllerInput& input, JointVector* torque) noexcept {
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  const Vector3 v = J_.topRows<3>().lazyProduct(*input.v);
  const double speed = v.norm();
  if (speed <= *spec_.speed_cap) return;
  const Vector3 direction = v / speed;
  const double damping = 1 / (Mobility(input, direction) * kSpeedCapTime);
  const Vector3 force = damping * (speed - *spec_.speed_cap) * direction;
  torque->noalias() -= J_.topRows<3>().transpose().lazyProduct(force);
}

// All joints decelerate together, the fastest at stop_deceleration. Then they hold.
void CobotSafety::StopTorque(const ControllerInput& input, double dt,
                             JointVector* torque) noexcept {
  q_stop_ += fade_ * dt * v_stop_;
  fade_ = std::max(0.0, fade_ - fade_rate_ * dt);
  const double omega = 2 * std::numbers::pi * kHoldFrequency;
  const JointVector wanted =
      omega * omega * (q_stop_ - *input.q) + 2 * omega * (fade_ * v_stop_ - *input.v);
  input.data->FrameJacobian(*input.model, input.end_effector, &J_);
  *torque = input.data->gravity() - J_.transpose().lazyProduct(load());
  torque->noalias() += input.data->M().lazyProduct(wanted);
}

void CobotSafety::Archive(StateArchive& a) noexcept {
  if (!is_on()) return;
  int stop = static_cast<int>(stop_);
  a(stop, v_before_, external_, F_E_W_, payload_, load_, further_);
  a(q_stop_, v_stop_, fade_, fade_rate_);
  if (stop < 0 || stop >= kCobotStops) return a.Fail();
  stop_ = static_cast<CobotStop>(stop);
}

}  // namespace predictor
