#include "safety/arm_brake.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kCreep = 0.05;  // factor below which an arm no longer waits for the other one

}  // namespace

double ArmBrake::RemainingDistance() const noexcept {
  StopProfile hard = brake_;
  hard.Begin(factor_ * first_, rate_);
  return hard.Distance();
}

ArmBrake::ArmBrake(const StopProfile& begun, double hold, double dt)
    : brake_(begun),
      first_(begun.speed()),
      hold_(hold),
      rate_(begun.rate()),
      dt_(dt),
      factor_(begun.done() ? 0 : 1) {}

double ArmBrake::Next(double common, double rate, double behind) noexcept {
  if (factor_ == 0) return 0;
  const bool holds = hold_ > 0.5 * dt_;
  apart_ = apart_ || holds || behind > 0;
  hold_ -= dt_;
  const double speed = factor_ * first_;
  if (!apart_) {
    rate_ = rate;
    return factor_ = common;
  }
  // The rate lies between the rate of braking as hard as allowed and the rate of releasing the
  // brake. Both rates respect the jerk bound.
  const double step = brake_.jerk() * dt_;
  const double soft_rate = rate_ < 0 ? std::min(0.0, rate_ + step) : std::max(0.0, rate_ - step);
  const double soft = speed + (rate_ + soft_rate) / 2 * dt_;
  brake_.Begin(speed, rate_);
  const double hard = brake_.SpeedAt(dt_), hard_rate = brake_.RateAt(dt_);
  // Near rest, the arm stops at once instead of creeping.
  const bool creeps = factor_ < kCreep && common == 0;
  const double wanted = holds ? soft : creeps ? 0 : (common + behind) * first_;
  const double share = soft > hard ? std::clamp((wanted - hard) / (soft - hard), 0.0, 1.0) : 0.0;
  rate_ = hard_rate + share * (soft_rate - hard_rate);
  factor_ = (hard + share * (soft - hard)) / first_;
  // Without this condition, rounding could leave a tiny residual speed.
  if (factor_ < 1e-9) factor_ = 0;
  return factor_;
}

}  // namespace predictor
