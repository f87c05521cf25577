// The hand's wrench out of the raw force/torque reading: bias, handle weight and inertia removed.
#pragma once

#include "core/archive.h"
#include "core/filters.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// One hand's estimator. The reading is what the handle exerts on the sensor:
//   F_S_raw = F_hand + weight − d(momentum)/dt + bias,
// so the hand's wrench is the reading less bias and weight, plus the rate of momentum, where the
// latter passes the same low-pass and delay as the sensor's own, or the two would not cancel.
//
// The measured acceleration is late too (MotionDifferentiator::Lag). It is delayed by so much less
// than the sensor delays. Only where the sensor is faster than that is the reading held back, by
// the difference: at most half a tick.
class HandEstimator {
 public:
  // X_EH: handle in the end-effector frame. dt: tick [s], at least 1 ms. gravity [m/s²].
  // acceleration_lag: age of the acceleration that Update is given [s]. Throws InputError.
  HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload, const Pose& X_EH,
                double gravity, double dt, double acceleration_lag);
  // The acceleration is MotionDifferentiator's at that tick.
  HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload, const Pose& X_EH,
                double gravity, double dt);

  // Hands off and at rest: averages readings into the bias. Call Tare each tick between the two.
  void BeginTare() noexcept;
  Status Tare(const ArmSample& sample, const Pose& X_WE) noexcept;
  // Takes the mean as the bias. Refuses (kSensor; the bias is as before) fewer than kTareSamples
  // readings, or readings that vary by more than the sensor's noise explains: somebody or something
  // touches the handle. Status: standard deviation seen and allowed, of the worst axis.
  Status FinishTare() noexcept;
  const Wrench& bias() const { return bias_; }
  // Standard deviation of readings that a sensor and a quiet room explain [N], [N·m].
  static Wrench QuietDeviation(const SensorSpec& sensor) noexcept;

  // Wrench of the hand at H. `end_effector` is E's motion with A_W filled in (measured
  // acceleration). Refuses what is not finite or saturated (kSensor); out is then zero.
  Status Update(const ArmSample& sample, const FrameMotion& end_effector, HandWrench* out) noexcept;

  // Forgets what is on its way in the filters; keeps the bias.
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
  double gravity_;
  double hold_back_, weight_delay_, inertia_delay_;  // [ticks]
  FractionalDelay<Wrench, 64> reading_, weight_, inertia_;
  RampLowPass<Wrench> low_pass_;
  bool filled_ = false;

  Wrench bias_ = Wrench::Zero();
  Wrench tare_first_ = Wrench::Zero();  // the sums are of differences from it, for precision
  Wrench tare_sum_ = Wrench::Zero();
  Wrench tare_squares_ = Wrench::Zero();
  int tare_count_ = 0;
};

}  // namespace predictor
