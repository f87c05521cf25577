#include "rig/velocity_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor {
namespace {

// Returns the state transition of (q, v, a, u) over h [s] for constant u. The transition is exp(F
// h), computed by scaling and squaring.
Eigen::Matrix4d Transition(double omega, double zeta, double h) {
  Eigen::Matrix4d F = Eigen::Matrix4d::Zero();
  F(0, 1) = F(1, 2) = 1;
  F.row(2) << 0, -omega * omega, -2 * zeta * omega, omega * omega;
  const int squarings = std::max(0, static_cast<int>(std::ceil(std::log2(omega * omega * h))) + 1);
  const Eigen::Matrix4d X = F * (h / std::pow(2.0, squarings));
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  for (int n = 1; n <= 12; ++n) {
    term = (term * X / n).eval();
    result += term;
  }
  for (int i = 0; i < squarings; ++i) result = (result * result).eval();
  return result;
}

}  // namespace

VelocityLoop::VelocityLoop(const VelocityLoopSpec& spec, double delay, double dt,
                           double velocity_limit, double acceleration_limit)
    : dt_(dt),
      velocity_limit_(velocity_limit),
      acceleration_limit_(acceleration_limit),
      delay_samples_(std::floor(delay / dt + 1e-9)) {
  const double omega = 2 * std::numbers::pi * spec.bandwidth;
  // The command changes at the time `rest` before the end of the step.
  const double fraction = std::max(0.0, delay / dt - delay_samples_);
  const double rest = (1 - fraction) * dt;
  const Eigen::Matrix4d before = Transition(omega, spec.damping_ratio, dt - rest);
  const Eigen::Matrix4d after = Transition(omega, spec.damping_ratio, rest);
  A_ = after.topLeftCorner<3, 3>() * before.topLeftCorner<3, 3>();
  older_ = after.topLeftCorner<3, 3>() * before.topRightCorner<3, 1>();
  newer_ = after.topRightCorner<3, 1>();
  Reset(0);
}

void VelocityLoop::Reset(double q) noexcept {
  q_ = q;
  v_ = a_ = previous_u_ = 0;
  commands_.Reset(static_cast<int>(delay_samples_), 0.0);
}

void VelocityLoop::Step(double u) noexcept {
  const double command = commands_.Update(std::clamp(u, -velocity_limit_, velocity_limit_));
  Vector3 x = A_ * Vector3(q_, v_, a_) + older_ * previous_u_ + newer_ * command;
  previous_u_ = command;
  const double limit = acceleration_limit_;
  if (std::abs(x[2]) > limit || std::abs(x[1] - v_) > limit * dt_) {
    const double a = std::clamp(x[2], -limit, limit);
    x = {q_ + v_ * dt_ + (2 * a_ + a) * dt_ * dt_ / 6, v_ + (a_ + a) * dt_ / 2, a};
  }
  if (std::abs(x[1]) > velocity_limit_) {
    const double v = std::clamp(x[1], -velocity_limit_, velocity_limit_);
    x = {q_ + (v_ + v) * dt_ / 2, v, 0};
  }
  q_ = x[0];
  v_ = x[1];
  a_ = x[2];
}

}  // namespace predictor
