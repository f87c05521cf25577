#include "rig/force_sensor.h"

#include <algorithm>
#include <cmath>

namespace predictor {

Wrench HandleLoad(const HandlePayloadSpec& handle, const FrameMotion& sensor, double gravity) {
  // Applies the Newton-Euler equations about the centre of mass C, in the axes of S.
  const FrameMotion C = MotionOfFixed(sensor, {handle.center_of_mass, Quaternion::Identity()});
  const Quaternion to_S = sensor.X_W.q.conjugate();
  const Vector3 a = to_S * Vector3(C.A_W.head<3>() + Vector3(0, 0, gravity));
  const Vector3 w = to_S * Vector3(C.V_W.tail<3>());
  const Vector3 alpha = to_S * Vector3(C.A_W.tail<3>());
  const Vector3 momentum = handle.inertia.cwiseProduct(w);
  Wrench F_C;
  F_C << -handle.mass * a, -handle.inertia.cwiseProduct(alpha) - w.cross(momentum);
  return ShiftWrench(F_C, handle.center_of_mass);
}

ForceSensor::ForceSensor(const SensorSpec& spec, const Wrench& bias, double dt, RandomStream random)
    : spec_(spec),
      bias_(bias),
      low_pass_(spec.cutoff_frequency, dt, Wrench::Zero()),
      delay_samples_(spec.delay / dt),
      random_(random) {
  Reset(Wrench::Zero());
}

void ForceSensor::Reset(const Wrench& F_S) noexcept {
  low_pass_.Reset(F_S);
  delay_.Reset(delay_samples_, F_S);
  Step(F_S);
}

void ForceSensor::Step(const Wrench& F_S) noexcept {
  const Wrench exact = delay_.Update(low_pass_.Update(F_S)) + bias_;
  saturated_ = false;
  for (int i = 0; i < 6; ++i) {
    const double noise = i < 3 ? spec_.noise_force : spec_.noise_torque;
    const double quantum = i < 3 ? spec_.force_resolution : spec_.torque_resolution;
    const double range = i < 3 ? spec_.range_force : spec_.range_torque;
    double value = exact[i] + noise * random_.Normal();
    if (quantum > 0) value = quantum * std::round(value / quantum);
    saturated_ = saturated_ || std::abs(value) > range;
    reading_[i] = std::clamp(value, -range, range);
  }
}

}  // namespace predictor
