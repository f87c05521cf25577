// Computes the hand's wrench from the raw force/torque reading by removing bias, handle weight and
// handle inertia.
#pragma once

#include "core/archive.h"
#include "core/filters.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// Estimates the wrench of one hand. The reading is the wrench that the handle exerts on the sensor,
// F_S_raw = F_hand + weight − d(momentum)/dt + bias. Therefore the hand's wrench is the reading
// minus bias and weight, plus the rate of change of momentum. The rate of change of momentum passes
// the same low-pass filter and delay as the sensor's signal. Otherwise it would not cancel the
// effect of the handle's inertia on the reading.
//
// The measured acceleration is delayed, too (MotionDifferentiator::Lag). The estimator therefore
// delays the acceleration further, by the sensor's delay minus this lag. If the sensor's delay is
// shorter than the lag, the estimator instead delays the reading by the difference, which is at
// most half a tick.
class HandEstimator {
 public:
  // `X_EH` is the pose of the handle in the end-effector frame. `dt` is the duration of a tick [s],
  // at least 1 ms. `gravity` is in [m/s²]. `acceleration_lag` is the age of the acceleration that
  // is passed to Update [s]. Throws InputError.
  HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload, const Pose& X_EH,
                double gravity, double dt, double acceleration_lag);
  // Assumes the acceleration lag of MotionDifferentiator with this duration of a tick.
  HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload, const Pose& X_EH,
                double gravity, double dt);

  // Begins to average readings into the bias. The handles must be free and at rest. Call Tare in
  // each tick until FinishTare.
  void BeginTare() noexcept;
  Status Tare(const ArmSample& sample, const Pose& X_WE) noexcept;
  // Sets the bias to the mean of the readings. Returns kSensor and keeps the previous bias if there
  // are fewer than kTareSamples readings, or if they vary more than the sensor's noise explains. If
  // they vary too much, a person or an object is touching the handle. The status contains the
  // observed and the allowed standard deviation of the worst axis.
  Status FinishTare() noexcept;
  const Wrench& bias() const { return bias_; }
  // Returns the largest standard deviation of the readings that sensor noise and the vibration of a
  // quiet room explain [N], [N·m].
  static Wrench QuietDeviation(const SensorSpec& sensor) noexcept;

  // Computes the wrench of the hand at H. `end_effector` is the motion of E, including the measured
  // acceleration A_W. Returns kSensor and sets `out` to zero if the reading is not finite, is
  // saturated, or exceeds the sensor's range along any axis. Saturation and an exceeded range also
  // request a stop without power.
  Status Update(const ArmSample& sample, const FrameMotion& end_effector, HandWrench* out) noexcept;

  // Clears the signals in the filters and delays but keeps the bias.
  void Reset() noexcept;

  static constexpr int kTareSamples = 50;

  void Archive(StateArchive& a) noexcept {
    a(reading_, weight_, inertia_, low_pass_, filled_, bias_, tare_first_, tare_sum_, tare_squares_,
      tare_count_);
  }

 private:
  Wrench Weight(const Quaternion& q_WS) const noexcept;
  Wrench Inertia(const FrameMotion& S) const noexcept;
  Status CheckReading(const ArmSample& sample) const noexcept;
  void Fill(const Wrench& reading, const Wrench& weight, const Wrench& inertia) noexcept;

  SensorSpec sensor_;
  HandlePayloadSpec payload_;
  Pose X_ES_, X_EH_;
  Matrix3 inertia_S_;  // of the handle about the origin of S, in its axes [kg·m²]
  double gravity_;
  double hold_back_, weight_delay_, inertia_delay_;  // [ticks]
  FractionalDelay<Wrench, 64> reading_, weight_, inertia_;
  RampLowPass<Wrench> low_pass_;
  bool filled_ = false;

  Wrench bias_ = Wrench::Zero();
  Wrench tare_first_ = Wrench::Zero();  // subtracted before summation, for precision
  Wrench tare_sum_ = Wrench::Zero();
  Wrench tare_squares_ = Wrench::Zero();
  int tare_count_ = 0;
};

}  // namespace predictor
