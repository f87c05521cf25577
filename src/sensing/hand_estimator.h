// The hand's wrench out of the raw force/torque reading: bias, handle weight and inertia removed.
#pragma once

#include "core/filters.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// One hand's estimator. The reading is what the handle exerts on the sensor:
//   F_S_raw = F_hand + weight − d(momentum)/dt + bias,
// so the hand's wrench is the reading less bias and weight, plus the rate of momentum, where the
// latter passes the same low-pass and delay as the sensor's own, or the two would not cancel.
class HandEstimator {
 public:
  // X_EH: handle in the end-effector frame. dt: tick [s]. gravity [m/s²].
  HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload, const Pose& X_EH,
                double gravity, double dt);

  // Hands-off: averages readings into the bias (call each tick while taring, then FinishTare).
  void BeginTare() noexcept;
  Status Tare(const ArmSample& sample, const Pose& X_WE) noexcept;
  void FinishTare() noexcept;
  const Wrench& bias() const { return bias_; }

  // Wrench of the hand at H. `end_effector` is E's motion with A_W filled in (measured
  // acceleration). Refuses what is not finite or saturated (kSensor); out is then zero.
  Status Update(const ArmSample& sample, const FrameMotion& end_effector, HandWrench* out) noexcept;

  void Reset() noexcept;

 private:
  Wrench Load(const Pose& X_WS, const Twist& V_WS, const Vector6& A_WS) const noexcept;
  SensorSpec sensor_;
  HandlePayloadSpec payload_;
  Pose X_ES_, X_EH_;
  double gravity_, dt_;
  Wrench bias_ = Wrench::Zero();
  Wrench tare_sum_ = Wrench::Zero();
  int tare_count_ = 0;
};

}  // namespace predictor
