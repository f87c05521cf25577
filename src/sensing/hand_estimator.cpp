#include "sensing/hand_estimator.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/motion.h"
#include "sensing/motion_differentiator.h"

namespace predictor {
namespace {

constexpr double kMaxDelayTicks = 60;
// Standard deviation that ambient vibration in a quiet room adds to the sensor's own noise during a
// tare [N], [N·m].
constexpr double kTareForce = 0.05;
constexpr double kTareTorque = 0.005;
constexpr double kTareFactor = 3;  // multiple of the sensor's own noise

}  // namespace

HandEstimator::HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload,
                             const Pose& X_EH, double gravity, double dt, double acceleration_lag)
    : sensor_(sensor),
      payload_(payload),
      X_ES_(sensor.pose.ToPose()),
      X_EH_(X_EH),
      inertia_S_(Matrix3(payload.inertia.asDiagonal()) -
                 payload.mass * Skew(payload.center_of_mass) * Skew(payload.center_of_mass)),
      gravity_(gravity),
      hold_back_(std::max(0.0, acceleration_lag - sensor.delay) / dt),
      weight_delay_(hold_back_ + sensor.delay / dt),
      inertia_delay_(std::max(0.0, weight_delay_ - acceleration_lag / dt)),
      low_pass_(sensor.cutoff_frequency, dt, Wrench::Zero()) {
  if (weight_delay_ > kMaxDelayTicks) {
    throw InputError("device.arms.*.sensor.delay",
                     "The sensor's delay is longer than 60 ticks. Use a faster sensor.");
  }
}

HandEstimator::HandEstimator(const SensorSpec& sensor, const HandlePayloadSpec& payload,
                             const Pose& X_EH, double gravity, double dt)
    : HandEstimator(sensor, payload, X_EH, gravity, dt, MotionDifferentiator::Lag(dt)) {}

Wrench HandEstimator::Weight(const Quaternion& q_WS) const noexcept {
  const Vector3 weight_S = q_WS.conjugate() * Vector3(0, 0, -payload_.mass * gravity_);
  Wrench F;
  F << weight_S, payload_.center_of_mass.cross(weight_S);
  return F;
}

Wrench HandEstimator::Inertia(const FrameMotion& S) const noexcept {
  // Rate of change of momentum about S, in axes of S.
  const Matrix3 R_SW = S.X_W.R().transpose();
  const Vector3 a = R_SW * S.A_W.head<3>();
  const Vector3 w = R_SW * S.V_W.tail<3>();
  const Vector3 alpha = R_SW * S.A_W.tail<3>();
  const Vector3& c = payload_.center_of_mass;
  const double m = payload_.mass;
  const Matrix3& I_S = inertia_S_;
  Wrench F;
  F << -m * (a + alpha.cross(c) + w.cross(w.cross(c))),
      -(m * c.cross(a) + I_S * alpha + w.cross(I_S * w));
  return F;
}

Status HandEstimator::CheckReading(const ArmSample& sample) const noexcept {
  const Wrench& F = sample.F_S_raw;
  const bool finite = F.allFinite();
  const double force = finite ? F.head<3>().cwiseAbs().maxCoeff() : 0;
  const double torque = finite ? F.tail<3>().cwiseAbs().maxCoeff() : 0;
  const bool beyond =
      sample.sensor_saturated || force > sensor_.range_force || torque > sensor_.range_torque;
  if (finite && !beyond) return Status::Ok();
  return {StopCause::kSensor,
          -1,
          force,
          sensor_.range_force,
          UsualQuantity(StopCause::kSensor),
          beyond};
}

void HandEstimator::BeginTare() noexcept {
  tare_count_ = 0;
  tare_sum_.setZero();
  tare_squares_.setZero();
}

Status HandEstimator::Tare(const ArmSample& sample, const Pose& X_WE) noexcept {
  const Status status = CheckReading(sample);
  if (!status.ok()) return status;
  const Wrench offset = sample.F_S_raw - Weight(X_WE.q * X_ES_.q);
  if (tare_count_ == 0) tare_first_ = offset;
  const Wrench difference = offset - tare_first_;
  tare_sum_ += difference;
  tare_squares_ += difference.cwiseProduct(difference);
  ++tare_count_;
  return status;
}

Wrench HandEstimator::QuietDeviation(const SensorSpec& sensor) noexcept {
  Wrench quiet;
  for (int i = 0; i < 6; ++i) {
    const double noise = i < 3 ? sensor.noise_force : sensor.noise_torque;
    const double quantum = i < 3 ? sensor.force_resolution : sensor.torque_resolution;
    const double own = std::sqrt(noise * noise + quantum * quantum / 12);
    quiet[i] = kTareFactor * own + (i < 3 ? kTareForce : kTareTorque);
  }
  return quiet;
}

Status HandEstimator::FinishTare() noexcept {
  if (tare_count_ < kTareSamples)
    return {StopCause::kSensor, -1, double(tare_count_), kTareSamples};
  const Wrench mean = tare_sum_ / tare_count_;
  const Wrench quiet = QuietDeviation(sensor_);
  Status worst;
  for (int i = 0; i < 6; ++i) {
    const double limit = quiet[i];
    const double seen =
        std::sqrt(std::max(0.0, tare_squares_[i] / tare_count_ - mean[i] * mean[i]));
    if (seen > limit && (worst.ok() || seen / limit > worst.value / worst.limit)) {
      worst = {StopCause::kSensor, -1, seen, limit, i < 3 ? Quantity::kForce : Quantity::kTorque};
    }
  }
  if (worst.ok()) bias_ = tare_first_ + mean;
  return worst;
}

void HandEstimator::Fill(const Wrench& reading, const Wrench& weight,
                         const Wrench& inertia) noexcept {
  reading_.Reset(hold_back_, reading);
  weight_.Reset(weight_delay_, weight);
  inertia_.Reset(inertia_delay_, inertia);
  low_pass_.Reset(weight + inertia);
  filled_ = true;
}

Status HandEstimator::Update(const ArmSample& sample, const FrameMotion& end_effector,
                             HandWrench* out) noexcept {
  out->present = sample.present;
  out->F_H_W.setZero();
  const Status status = CheckReading(sample);
  if (!status.ok()) return status;

  const FrameMotion S = MotionOfFixed(end_effector, X_ES_);
  const Wrench weight = Weight(S.X_W.q);
  const Wrench inertia = Inertia(S);
  if (!filled_) Fill(sample.F_S_raw, weight, inertia);
  const Wrench load = low_pass_.Update(weight_.Update(weight) + inertia_.Update(inertia));
  const Wrench F_S = reading_.Update(sample.F_S_raw) - bias_ - load;

  Wrench F_S_W;
  F_S_W << S.X_W.q * Vector3(F_S.head<3>()), S.X_W.q * Vector3(F_S.tail<3>());
  const Pose X_WH = end_effector.X_W * X_EH_;
  out->F_H_W = ShiftWrench(F_S_W, S.X_W.p - X_WH.p);
  return status;
}

void HandEstimator::Reset() noexcept { filled_ = false; }

}  // namespace predictor
