// Computes joint accelerations from measured joint velocities.
#pragma once

#include "core/archive.h"
#include "core/messages.h"

namespace predictor {

// a = difference between the last two different samples of v, divided by the time between them. The
// acceleration is not filtered here. HandEstimator passes the acceleration through the sensor's
// low-pass filter, which removes the noise, and compensates for the lag.
class MotionDifferentiator {
 public:
  // `dt` is the duration of a tick [s].
  explicit MotionDifferentiator(double dt, int joints = 0)
      : dt_(dt), v_(JointVector::Zero(joints)), a_(JointVector::Zero(joints)) {}

  // Returns the age of the acceleration [s] if the arm is sampled in every tick, which is half the
  // time between samples.
  static double Lag(double dt) { return dt / 2; }

  // Call this once per tick. Returns the joint accelerations [rad/s²]. If a sample is repeated
  // (with the same arm_sequence), these accelerations do not change.
  const JointVector& Update(const ArmSample& sample) noexcept;
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept { a(v_, a_, sequence_, ticks_, started_); }

 private:
  double dt_;
  JointVector v_, a_;
  std::uint64_t sequence_ = 0;
  int ticks_ = 0;  // ticks since the last new sample
  bool started_ = false;
};

}  // namespace predictor
