// A high-pass filter that shares no code with the program's filters.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace predictor {

// A fourth-order Butterworth high-pass filter at 10 Hz, as two biquads from the bilinear transform
// in direct form II. The filter starts in the steady state of its first sample.
class HighPass {
 public:
  explicit HighPass(double dt) {
    const double c = 1 / std::tan(std::numbers::pi * 10 * dt);
    for (std::size_t i = 0; i < 2; ++i) {
      const double b = 2 * std::cos(std::numbers::pi * (1 + 2 * static_cast<double>(i)) / 8);
      const double a0 = c * c + b * c + 1;
      gain_[i] = c * c / a0;
      a1_[i] = 2 * (1 - c * c) / a0;
      a2_[i] = (c * c - b * c + 1) / a0;
    }
  }
  double Step(double x) {
    if (!started_) start_ = x;
    started_ = true;
    x -= start_;
    for (std::size_t i = 0; i < 2; ++i) {
      const double w = x - a1_[i] * w1_[i] - a2_[i] * w2_[i];
      x = gain_[i] * (w - 2 * w1_[i] + w2_[i]);
      w2_[i] = w1_[i];
      w1_[i] = w;
    }
    return x;
  }

 private:
  std::array<double, 2> gain_{}, a1_{}, a2_{}, w1_{}, w2_{};
  double start_ = 0;
  bool started_ = false;
};

}  // namespace predictor
