#include "simulation/controllers/minimum_jerk_estimate.h"

#include <algorithm>
#include <cmath>

#include "core/minimum_jerk.h"

namespace predictor::controllers {
namespace {

constexpr double kRestShare = 0.25;    // of the onset speed
constexpr int kIterations = 8;         // for the beginning of the movement
constexpr double kMinSpeed = 1e-6;     // [m/s]
constexpr double kMinDistance = 1e-5;  // [m]
constexpr double kMaxDuration = 100;   // [s]

double RatioAt(double s) noexcept { return 30 * (1 - s) * (1 - s) / (10 + s * (-15 + 6 * s)); }

// Inverts RatioAt.
double PhaseAt(double ratio) noexcept {
  const double r = std::clamp(ratio, 0.0, 3.0);
  return (60 - 15 * r - std::sqrt(15 * r * (8 - r))) / (60 - 12 * r);
}

}  // namespace

Vector3 MinimumJerkEstimate::Velocity() const noexcept {
  return MinimumJerkRate(phase) / duration * distance;
}

Vector3 MinimumJerkEstimate::Acceleration() const noexcept {
  const double s = phase;
  return 60 * s * (1 - s) * (1 - 2 * s) / (duration * duration) * distance;
}

void MovementOnset::Advance(const Vector3& p, const Vector3& v, double onset_speed,
                            double dt) noexcept {
  const double speed = v.norm();
  if (speed < kRestShare * onset_speed) {
    at_[kMoving] = 0;
    Vector3::Map(at_ + kRest) = p;
    at_[kSpeed] = speed;
    at_[kTime] = 0;
  } else if (!is_moving() && speed > onset_speed) {
    at_[kMoving] = 1;
    at_[kGrowth] = std::sqrt(speed / std::max(at_[kSpeed], kMinSpeed));
    at_[kNoticed] = at_[kTime];
  }
  at_[kTime] += dt;
}

MinimumJerkEstimate MovementOnset::Estimate(const Vector3& p, const Vector3& v) const noexcept {
  MinimumJerkEstimate estimate;
  estimate.phase = estimate.duration = 1;
  const Vector3 moved = p - Vector3::Map(at_ + kRest);
  const double distance = moved.norm();
  if (!is_moving() || distance < kMinDistance || moved.dot(v) <= 0) return estimate;
  const double speed = moved.dot(v) / distance, since = at_[kNoticed];
  double x = distance;
  estimate.duration = kMaxDuration;
  for (int i = 0; i < kIterations; ++i) {
    const double growth = at_[kGrowth] / std::max(1 - since / estimate.duration, 0.5);
    const double before = since / std::max(growth - 1, 0.1);
    const double t = before + at_[kTime];
    x = distance + at_[kSpeed] * before / RatioAt(std::min(before / estimate.duration, 0.5));
    estimate.phase = PhaseAt(t * speed / x);
    estimate.duration = std::min(t / std::max(estimate.phase, 1e-3), kMaxDuration);
  }
  estimate.distance = x / std::max(MinimumJerk(estimate.phase), 1e-9) * moved / distance;
  return estimate;
}

}  // namespace predictor::controllers
