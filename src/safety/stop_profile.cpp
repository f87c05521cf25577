#include "safety/stop_profile.h"

#include <algorithm>
#include <cmath>

namespace predictor {

StopProfile::StopProfile(double acceleration, double jerk, double dt, double speed_cap)
    : acceleration_(acceleration), jerk_(jerk), dt_(dt), cap_(speed_cap) {}

void StopProfile::Begin(double speed, double rate) noexcept {
  tick_ = 0;
  speed_ = std::isfinite(speed) ? std::max(0.0, speed) : 0;
  done_ = speed_ == 0;
  // The speed may still increase by `gain`. If the deceleration were below `lowest`, the speed
  // would pass through zero.
  const double gain = std::max(0.0, std::min(cap_ - speed_, (kOvershoot - 1) * speed_));
  const double highest = std::min(acceleration_, std::sqrt(2 * jerk_ * gain));
  const double lowest = std::max(-acceleration_, -std::sqrt(2 * jerk_ * speed_));
  rate_ = std::isfinite(rate) ? std::clamp(rate, lowest, highest) : 0;
  // The deceleration increases to the peak with jerk −j, remains constant, and decreases to zero
  // with jerk +j. If there is no constant phase, the two ramps reduce the speed by (2 peak² −
  // rate²)/2j.
  const double peak = std::sqrt(jerk_ * speed_ + rate_ * rate_ / 2);
  peak_ = std::min(acceleration_, peak);
  const double lost = (2 * peak_ * peak_ - rate_ * rate_) / (2 * jerk_);
  ramp_in_ = (rate_ + peak_) / jerk_;
  hold_ = peak_ < peak ? (speed_ - lost) / peak_ : 0;
  ramp_out_ = peak_ / jerk_;
}

double StopProfile::SpeedAt(double t) const noexcept {
  if (t < ramp_in_) return speed_ + t * (rate_ - jerk_ * t / 2);
  const double left = duration() - t;
  if (left <= 0) return 0;
  if (left < ramp_out_) return jerk_ * left * left / 2;
  return jerk_ * ramp_out_ * ramp_out_ / 2 + peak_ * (left - ramp_out_);
}

double StopProfile::RateAt(double t) const noexcept {
  if (t < ramp_in_) return rate_ - jerk_ * t;
  const double left = duration() - t;
  if (left <= 0) return 0;
  return left < ramp_out_ ? -jerk_ * left : -peak_;
}

double StopProfile::Next() noexcept {
  if (done_) return 0;
  const double speed = SpeedAt(++tick_ * dt_);
  // Without this condition, rounding could leave a residual speed of 1e-20 m/s.
  done_ = speed < 1e-12 * speed_ || tick_ * dt_ >= duration();
  return done_ ? 0 : speed / speed_;
}

double StopProfile::Distance() const noexcept {
  const double in = ramp_in_, out = ramp_out_;
  const double v = speed_ + in * (rate_ - jerk_ * in / 2);
  return in * (speed_ + in * (rate_ / 2 - jerk_ * in / 6)) + hold_ * (v - peak_ * hold_ / 2) +
         jerk_ * out * out * out / 6;
}

}  // namespace predictor
