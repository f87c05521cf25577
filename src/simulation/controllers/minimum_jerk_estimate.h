// Estimates a point-to-point movement while it happens. The estimate uses the minimum-jerk model
// x(t) = a p(t / T), p(s) = 10 s³ − 15 s⁴ + 6 s⁵ (Flash & Hogan 1985).
//
// Let t be the time since the movement began. The ratio ρ = t ẋ / x = s p'(s) / p(s) = 30 (1 − s)²
// / (10 − 15 s + 6 s²) then depends only on the phase s = t / T, and falls from 3 to 0. The phase
// follows from this ratio by a quadratic equation. The results T = t / s and a = x / p(s) need
// neither iteration nor past samples.
//
// A movement is detected late, when its speed has grown by a factor r² in the time Δ since the last
// sample at rest. Since the speed is proportional to (s (1 − s))², the movement began τ = Δ / (r /
// (1 − Δ / T) − 1) before that sample. Up to that sample, it had covered the distance ẋ τ / ρ(τ /
// T).
#pragma once

#include "core/types.h"

namespace predictor::controllers {

struct MinimumJerkEstimate {
  double phase = 0;                    // s, 0 to 1; 1: over, or not a movement of this kind
  double duration = 0;                 // T [s]
  Vector3 distance = Vector3::Zero();  // a [m]

  Vector3 Velocity() const noexcept;      // at the phase [m/s]
  Vector3 Acceleration() const noexcept;  // [m/s²]
};

// The values in a controller's memory that the estimate needs from the past. These values are 0 at
// the start.
class MovementOnset {
 public:
  static constexpr int kSize = 8;
  explicit MovementOnset(double* numbers) : at_(numbers) {}

  bool is_moving() const noexcept { return at_[kMoving] > 0.5; }
  // Advances the estimate by dt [s] at the position p [m] and velocity v [m/s]. A movement begins
  // above `onset_speed` [m/s] and ends below a quarter of it.
  void Advance(const Vector3& p, const Vector3& v, double onset_speed, double dt) noexcept;
  MinimumJerkEstimate Estimate(const Vector3& p, const Vector3& v) const noexcept;

 private:
  // The values are 0 or 1 (whether a movement is under way), the position [m] and speed [m/s] of
  // the last sample at rest, the time since that sample [s], r, and Δ.
  enum { kMoving, kRest, kSpeed = kRest + 3, kTime, kGrowth, kNoticed };

  double* at_;
};

}  // namespace predictor::controllers
