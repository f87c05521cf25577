// Detects that a handle runs away with its own hand: a sensor that reads mirrored.
#pragma once

#include "core/archive.h"
#include "core/types.h"

namespace predictor {

// A hand holds its place like a spring: the force that it exerts along its motion falls as the
// handle goes along with it. Where a sensor reads another way than the hand pushes, the handle goes
// against the hand, which resists the more, and so the force grows with the motion that it causes:
// the power that flows from the hand into the handle by what is measured flows the other way in
// truth, and both grow, as e^{λt}, until a threshold stops it. Where the force along the motion and
// the speed have grown like that for kGrowing, and for kTime of it beyond kForce and kSpeed of the
// handle's cap, it is that. What a person does is over sooner: a sudden push grows faster than
// kFastest, and whoever means to move that far is past the greatest force before the handle is so
// fast. What runs away faster than kFastest is at the thresholds of force soon, which see it
// however a sensor is mounted. Not seen by this, but by the push test, is a mirrored sensor that
// does not run away, since the other hand or the virtual cobot holds against it.
class RunawayDetector {
 public:
  static constexpr double kGrowth = 3, kFastest = 10;       // λ [1/s]
  static constexpr double kLeastForce = 1.5, kForce = 6;    // to grow from; to count [N]
  static constexpr double kLeastSpeed = 0.1, kSpeed = 0.4;  // the same, of the handle's cap
  static constexpr double kAtCap = 0.95;                    // of it: there the speed need not grow
  static constexpr double kGrowing = 0.180, kTime = 0.080;  // [s]

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
    growing_ = time_ = 0;
  }
  void Archive(StateArchive& a) noexcept { a(force_, speed_, growing_, time_); }

 private:
  // Two low-passes of one signal: that the quicker is ahead tells how it grows.
  struct Trend {
    double fast = 0, slow = 0;
    void Step(double x, double dt) noexcept;
    bool GrowsFasterThan(double rate) const noexcept;  // [1/s]
    void Archive(StateArchive& a) noexcept { a(fast, slow); }
  };

  double cap_ = 0.25, dt_ = 0.001;
  Trend force_, speed_;
  // For which both have grown, and beyond that; they fall twice as fast as they rise [s].
  double growing_ = 0, time_ = 0;
};

}  // namespace predictor
