// The speed profile of a stop.
#pragma once

#include <limits>

#include "core/archive.h"

namespace predictor {

// Scales both arms' last command down to 0 by one common factor, so that the handles keep their
// relative pose. The faster handle comes to rest in the shortest time that its bounds on
// acceleration and jerk allow (closed form, sampled in each tick).
//
// The jerk bound does not allow an accelerating motion to brake at once. Therefore, the factor
// first rises above 1, by rate²/(2·jerk·speed). The factor never exceeds kOvershoot, and the speed
// never exceeds the cap. A larger rate is reduced at once, because the last command of a motion
// that has barely begun does not show the motion's direction reliably.
//
// A factor that is common to all joints scales the handles' twists equally as long as the Jacobians
// do not change. During the few centimetres of a stop, the Jacobians do change. StopController
// corrects the effect of this change.
class StopProfile {
 public:
  static constexpr double kOvershoot = 1.25;  // largest factor

  StopProfile() = default;
  // acceleration [m/s²], jerk [m/s³] and cap of the speed [m/s] are all at the handles. `dt` is in
  // [s].
  StopProfile(double acceleration, double jerk, double dt,
              double speed_cap = std::numeric_limits<double>::infinity());
  // Begins the profile at the handles' present speed and acceleration along their motion. `speed`
  // [m/s] is the speed of the faster handle, in which a rotation is multiplied by 0.2 m, and `rate`
  // [m/s²] is its derivative. If the speed is zero or not finite, the profile is at rest at once.
  void Begin(double speed, double rate) noexcept;
  // Returns the factor for the next tick, in [0, kOvershoot]. At rest, the factor is 0.
  double Next() noexcept;
  // Returns the speed [m/s] and the rate [m/s²] of the curve at a time t [s] after Begin.
  double SpeedAt(double t) const noexcept;
  double RateAt(double t) const noexcept;
  // Returns whether the profile is at rest, because the last factor was 0.
  bool done() const noexcept { return done_; }
  // Returns the time from Begin to rest [s].
  double duration() const noexcept { return ramp_in_ + hold_ + ramp_out_; }
  // Returns the distance from Begin to rest [m].
  double Distance() const noexcept;
  double speed() const noexcept { return speed_; }  // speed at the beginning [m/s]
  double rate() const noexcept { return rate_; }    // [m/s²]
  double rate_now() const noexcept { return RateAt(tick_ * dt_); }
  double jerk() const noexcept { return jerk_; }  // [m/s³]
  void Archive(StateArchive& a) noexcept {
    a(acceleration_, jerk_, dt_, cap_, speed_, rate_, peak_, ramp_in_, hold_, ramp_out_, tick_,
      done_);
  }

 private:
  double acceleration_ = 5, jerk_ = 250, dt_ = 0.001;
  double cap_ = std::numeric_limits<double>::infinity();
  double speed_ = 0, rate_ = 0;                   // speed and rate at the beginning [m/s], [m/s²]
  double peak_ = 0;                               // largest deceleration [m/s²]
  double ramp_in_ = 0, hold_ = 0, ramp_out_ = 0;  // times to ramp in, hold and ramp out [s]
  int tick_ = 0;
  bool done_ = true;
};

}  // namespace predictor
