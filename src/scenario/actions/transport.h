// The action that moves and rotates the object with minimum jerk, which move, rotate and put_down
// use.
#pragma once

#include "core/minimum_jerk.h"
#include "scenario/actions/action.h"

namespace predictor {

class Transport : public Action {
 public:
  // The object moves by `by` [m] and `rotate_by` [rad] in W, within `duration` [s].
  Transport(double duration, const Vector3& by, const Vector3& rotate_by)
      : duration_(duration), by_(by), rotate_by_(rotate_by) {}
  void Begin(Intent*) noexcept override { phase_ = 0; }
  bool Advance(double dt, double pace, Intent* intent) noexcept override {
    const double before = MinimumJerk(phase_);
    phase_ += pace * dt / duration_;
    const double step = MinimumJerk(phase_) - before;
    const double rate = MinimumJerkRate(phase_) * pace / duration_;
    intent->Move(step * by_, rate * by_);
    intent->Turn(step * rotate_by_, rate * rotate_by_);
    return phase_ < 1;
  }
  bool NeedsHold() const noexcept override { return true; }
  void Archive(StateArchive& a) noexcept override { a(phase_); }

 private:
  double duration_;
  Vector3 by_, rotate_by_;
  double phase_ = 0;
};

}  // namespace predictor
