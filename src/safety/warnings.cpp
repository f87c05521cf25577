#include "safety/warnings.h"

#include <algorithm>
#include <cmath>

namespace predictor {

void Warnings::Link::Count(const LinkCounts& now, double dt) noexcept {
  const auto add = [&](std::uint64_t from, std::uint64_t to, double* sum) {
    const double fresh = known >= kStartTime && to > from ? static_cast<double>(to - from) : 0;
    *sum += fresh - *sum * std::min(1.0, dt);
  };
  add(last.taken, now.taken, &taken);
  add(last.lost, now.lost, &lost);
  add(last.refused, now.refused, &refused);
  last = now;
  known += dt;
}

void Warnings::Compare(std::size_t hand, Warning warning, double value, double limit) noexcept {
  values_[hand][static_cast<std::size_t>(warning)] = value;
  if (value > limit) Set(hand, warning, true);
  if (value < limit / 2) Set(hand, warning, false);
}

void Warnings::Set(std::size_t hand, Warning warning, bool in_force) noexcept {
  const unsigned bit = 1U << static_cast<unsigned>(warning);
  bits_[hand] = static_cast<std::uint8_t>(in_force ? bits_[hand] | bit : bits_[hand] & ~bit);
}

void Warnings::UpdateDrift(std::size_t hand, const Vector3& force, bool rests) noexcept {
  Line& line = lines_[hand];
  if (!rests || !force.allFinite()) {
    line = {};
    return;
  }
  if (line.n == 0) line.first = force;  // subtracted before summation, for precision
  const Vector3 x = force - line.first;
  const double t = line.n * dt_;
  line.n += 1;
  line.t += t;
  line.tt += t * t;
  line.f += x;
  line.tf += t * x;
  line.ff += x.cwiseProduct(x);
  if (t < kDriftTime) return;
  const double var_t = line.tt / line.n - line.t * line.t / (line.n * line.n);
  const Vector3 cov = line.tf / line.n - line.t * line.f / (line.n * line.n);
  const Vector3 var = line.ff / line.n - (line.f / line.n).cwiseAbs2();
  const Vector3 slope = cov / var_t;
  const double rest = std::sqrt(std::max(0.0, (var - var_t * slope.cwiseAbs2()).maxCoeff()));
  if (rest < quiet_[hand]) Compare(hand, Warning::kBiasDrift, 60 * slope.norm(), kMaxDrift);
  line = {};
}

void Warnings::Update(const WarningInput& input) noexcept {
  if (!input.sample) return;
  for (const int hand : input.present) {
    const ArmSample& sample = input.sample->arms[hand];
    arm_[hand].Count(sample.arm_link, dt_);
    sensor_[hand].Count(sample.sensor_link, dt_);
    Compare(hand, Warning::kArmLoss, arm_[hand].share(), kMaxLost);
    Compare(hand, Warning::kSensorLoss, sensor_[hand].share(), kMaxLost);
    Compare(hand, Warning::kRefused, arm_[hand].refused + sensor_[hand].refused, kMaxRefused);
    Set(hand, Warning::kNoPowerOff, sample.no_power_off);
    Set(hand, Warning::kKeepsPower, sample.keeps_power);
    UpdateDrift(hand, input.wrench[hand].F_H_W.head<3>(), input.rests);
  }
}

}  // namespace predictor
