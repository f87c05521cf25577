#include "simulation/wrist_sensor.h"

#include <cmath>

namespace predictor {

WristSensor::WristSensor(const WristSensorSpec& spec, std::uint64_t seed)
    : spec_(spec), start_(seed, "wrist sensor"), random_(start_) {
  bias_ = Eigen::Map<const Vector6>(spec.bias.data());
}

double WristSensor::cutoff() const noexcept { return 2 * 3.14159265358979323846 * spec_.low_pass; }

void WristSensor::Reset(const Wrench& F_E_W) noexcept {
  filtered_ = F_E_W;
  noise_.setZero();
  random_ = start_;
}

void WristSensor::Step(const Wrench& F_E_W, double dt) noexcept {
  filtered_ += (1 - std::exp(-cutoff() * dt)) * (F_E_W - filtered_);
  for (int i = 0; i < 6; ++i)
    noise_[i] = (i < 3 ? spec_.noise_force : spec_.noise_torque) * random_.Normal();
}

}  // namespace predictor
