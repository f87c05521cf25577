// Detects that a handle runs away with its own hand: a sensor that reads mirrored.
#pragma once

#include "core/archive.h"
#include "core/types.h"

namespace predictor {

// A hand holds its place like a spring: the force that it exerts along its motion falls as the
// handle goes along with it. Where a sensor reads another way than the hand pushes, the handle goes
// against the hand, which resists the more, and so the force grows with the motion that it causes:
// the power that flows from the hand into the handle by what is measured flows the other way in
// truth, and grows until a threshold stops it. Where both the force along the motion, beyond
// kForce, and the speed, beyond kSpeed of the handle's cap, grow by more than kGrowth for kTime, it
// is that: whoever means to move that far is past the greatest force before the handle is so fast.
// At the cap the speed need not grow. A mirrored sensor that does not run away, since the other
// hand or the virtual cobot holds against it, is not seen by this, but by the push test.
class RunawayDetector {
 public:
  static constexpr double kGrowth = 3;    // [1/s]
  static constexpr double kSpeed = 0.4;   // of the handle's cap
  static constexpr double kAtCap = 0.95;  // of it
  static constexpr double kForce = 6;     // [N]
  static constexpr double kTime = 0.080;  // [s]

  RunawayDetector() = default;
  // cap: of a handle's speed [m/s]. dt: of Update [s].
  RunawayDetector(double cap, double dt) : cap_(cap), dt_(dt) {}
  // A hand's force on its handle and the handle's velocity, in W, finite. True once it runs away.
  // No heap.
  bool Update(const Vector3& force, const Vector3& velocity) noexcept;
  double speed() const noexcept { return speed_.fast; }        // of late [m/s]
  double threshold() const noexcept { return kSpeed * cap_; }  // [m/s]
  void Reset() noexcept {
    force_ = speed_ = {};
    time_ = 0;
  }
  void Archive(StateArchive& a) noexcept { a(force_, speed_, time_); }

 private:
  // Two low-passes of one signal: that the quicker is ahead tells how it grows.
  struct Trend {
    double fast = 0, slow = 0;
    void Step(double x, double dt) noexcept;
    bool Grows() const noexcept;
    void Archive(StateArchive& a) noexcept { a(fast, slow); }
  };

  double cap_ = 0.25, dt_ = 0.001;
  Trend force_, speed_;
  double time_ = 0;  // for which it has been so; falls twice as fast as it rises [s]
};

}  // namespace predictor
