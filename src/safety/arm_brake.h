// Computes the braking of one arm during a stop.
#pragma once

#include "core/archive.h"
#include "safety/stop_profile.h"

namespace predictor {

// Brakes one arm during a stop along the common profile. While the other arm lags behind, the arm
// brakes less than this profile. The arm never accelerates in order to wait for the other arm, and
// it stays within the profile's bounds.
class ArmBrake {
 public:
  ArmBrake() = default;
  // `hold` is the delay before the arm begins to brake [s].
  ArmBrake(const StopProfile& begun, double hold, double dt);
  // Returns the factor for the next tick. `common` is the profile's factor in that tick. `rate` is
  // the profile's rate in that tick [m/s²]. `behind` is the share of the initial speed by which
  // this arm must exceed the profile's speed in order to keep up with the other arm.
  double Next(double common, double rate, double behind) noexcept;
  // Returns the distance that the arm still moves until it rests if it brakes as hard as the
  // profile's bounds allow [m].
  double RemainingDistance() const noexcept;
  bool done() const noexcept { return factor_ == 0; }
  double factor() const noexcept { return factor_; }  // factor of the last tick
  void Archive(StateArchive& a) noexcept { a(brake_, first_, hold_, rate_, dt_, factor_, apart_); }

 private:
  StopProfile brake_;
  double first_ = 0;   // speed when the stop began [m/s]
  double hold_ = 0;    // remaining delay [s]
  double rate_ = 0;    // [m/s²]
  double dt_ = 0.001;  // [s]
  double factor_ = 0;
  bool apart_ = false;  // no longer follows the common profile
};

}  // namespace predictor
