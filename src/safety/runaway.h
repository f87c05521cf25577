// Detects a handle that drives its own motion because its sensor is mirrored.
#pragma once

#include "core/archive.h"
#include "core/types.h"

namespace predictor {

// A hand resists displacement like a spring, so its force along the motion falls as the handle
// moves with it. If a sensor reports a different direction from that of the push, the handle moves
// against the hand. The hand resists more, so the force grows with the motion that it causes, and
// both grow as e^{λt} until a threshold stops the run. This detector reports a runaway under two
// conditions. The force along the motion and the speed must have grown as e^{λt} for kGrowing. For
// kTime of this period, the force must have exceeded kForce, and the speed must have exceeded the
// share kSpeed of the handle's cap.
//
// A person's own motion does not meet these conditions. A sudden push grows faster than kMaxGrowth,
// and in a large motion the force peaks before the handle reaches that speed. A runaway that grows
// faster than kMaxGrowth soon reaches the force thresholds, whatever the orientation of the sensor.
// If the other hand or the virtual cobot prevents a mirrored sensor from causing a runaway, only
// the push test finds it.
class RunawayDetector {
 public:
  static constexpr double kMinGrowth = 3, kMaxGrowth = 10;  // λ [1/s]
  static constexpr double kMinForce = 1.5,
                          kForce = 6;  // thresholds for growing and for counting [N]
  // The thresholds of the speed for growing and for counting, as shares of the handle's cap.
  static constexpr double kMinSpeed = 0.1, kSpeed = 0.4;
  static constexpr double kAtCap = 0.95;  // share of the cap above which the speed need not grow
  static constexpr double kGrowing = 0.180, kTime = 0.080;  // [s]

  RunawayDetector() = default;
  // `cap` is the limit of a handle's speed [m/s]. `dt` is the time between calls of Update [s].
  RunawayDetector(double cap, double dt) : cap_(cap), dt_(dt) {}
  // `force` is the force of the hand on its handle. `velocity` is the velocity of the handle. Both
  // vectors are finite and in the axes of W. Returns whether the handle runs away. Does not use the
  // heap.
  bool Update(const Vector3& force, const Vector3& velocity) noexcept;
  double speed() const noexcept { return speed_.fast; }        // after the low-pass filter [m/s]
  double threshold() const noexcept { return kSpeed * cap_; }  // [m/s]
  void Reset() noexcept {
    force_ = speed_ = {};
    growing_ = time_ = 0;
  }
  void Archive(StateArchive& a) noexcept { a(force_, speed_, growing_, time_); }

 private:
  // The two low-pass filters of one signal. The lead of the faster filter shows how fast the signal
  // grows.
  struct Trend {
    double fast = 0, slow = 0;
    void Step(double x, double dt) noexcept;
    bool GrowsFasterThan(double rate) const noexcept;  // [1/s]
    void Archive(StateArchive& a) noexcept { a(fast, slow); }
  };

  double cap_ = 0.25, dt_ = 0.001;
  Trend force_, speed_;
  // The time for which force and speed have both grown, and the part of this time in which both
  // exceeded the thresholds. Each of these two times decreases twice as fast as it increases [s].
  double growing_ = 0, time_ = 0;
};

}  // namespace predictor
