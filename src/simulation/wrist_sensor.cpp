#include "simulation/wrist_sensor.h"

#include <numbers>

namespace predictor {

WristSensor::WristSensor(const WristSensorSpec& spec, double dt, std::uint64_t seed)
    : spec_(spec),
      filter_(spec.cutoff_frequency, dt, Wrench::Zero()),
      start_(seed, "wrist sensor"),
      random_(start_) {
  bias_ = Eigen::Map<const Vector6>(spec.bias.data());
}

double WristSensor::cutoff() const noexcept {
  return 2 * std::numbers::pi * spec_.cutoff_frequency;
}

void WristSensor::Reset(const Wrench& F_E_W) noexcept {
  filter_.Reset(F_E_W);
  noise_.setZero();
  random_ = start_;
}

void WristSensor::Step(const Wrench& F_E_W) noexcept {
  filter_.Update(F_E_W);
  for (int i = 0; i < 6; ++i)
    noise_[i] = (i < 3 ? spec_.noise_force : spec_.noise_torque) * random_.Normal();
}

}  // namespace predictor
