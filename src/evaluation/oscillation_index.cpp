#include "evaluation/oscillation_index.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace predictor {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

OscillationIndex::OscillationIndex(double dt)
    : dt_(dt),
      each_(static_cast<int>(
          std::max(1L, std::lround(kWindow / static_cast<double>(kSamples) / dt)))) {
  samples_.reserve(kSamples);
}

const OscillationIndex::Window* OscillationIndex::Add(double time, const Vector3& force) noexcept {
  sum_ += force;
  time_ = time;
  if (++count_ < each_) return nullptr;
  samples_.push_back(sum_ / each_);
  sum_.setZero();
  count_ = 0;
  if (samples_.size() < kSamples) return nullptr;
  Close();
  samples_.erase(samples_.begin(), samples_.begin() + kSamples / 2);
  return &window_;
}

void OscillationIndex::Break() noexcept {
  samples_.clear();
  sum_.setZero();
  count_ = 0;
}

void OscillationIndex::Close() noexcept {
  const double step = each_ * dt_;  // sampling time [s]
  const double length = step * static_cast<double>(kSamples);
  Vector3 mean = Vector3::Zero();
  for (const Vector3& force : samples_) mean += force / static_cast<double>(kSamples);
  double squares = 0;  // sum of the squared weights of the window
  std::array<double, kSamples> weight{};
  for (std::size_t i = 0; i < kSamples; ++i) {
    weight[i] = 0.5 - 0.5 * std::cos(2 * kPi * static_cast<double>(i) / kSamples);
    squares += weight[i] * weight[i];
  }
  double total = 0, high = 0;  // [N²]
  for (int k = 1; k / length <= kHigh + 1e-9; ++k) {
    const double f = k / length;
    // Returns the factor by which the averaging of a sample's ticks attenuates this frequency.
    const double gain = std::abs(std::sin(kPi * f * step) / (each_ * std::sin(kPi * f * dt_)));
    const std::complex<double> turn = std::polar(1.0, -2 * kPi * k / static_cast<double>(kSamples));
    std::array<std::complex<double>, 3> sum{};
    std::complex<double> phase = 1;
    for (std::size_t i = 0; i < kSamples; ++i, phase *= turn)
      for (int axis = 0; axis < 3; ++axis)
        sum[static_cast<std::size_t>(axis)] += weight[i] * (samples_[i][axis] - mean[axis]) * phase;
    double power = 0;
    for (const auto& s : sum) power += std::norm(s);
    power *= 2 / (static_cast<double>(kSamples) * squares * gain * gain);
    total += power;
    if (f >= kLow - 1e-9) high += power;
  }
  window_ = {time_ - length / 2, total > 0 ? high / total : 0, std::sqrt(high), std::sqrt(total)};
}

}  // namespace predictor
