// Second-order Butterworth filters, which have a maximally flat pass band, for evenly sampled
// signals.
#pragma once

#include <cmath>
#include <numbers>

namespace predictor {

// A low-pass or high-pass filter, designed with the bilinear transform and a prewarped cut-off
// frequency. The filter starts in the state that it would have if it had always received its first
// sample.
template <class T>
class Butterworth {
 public:
  enum class Pass { kLow, kHigh };
  // `cutoff` [Hz] must be below half of the sampling rate. `dt` is in [s].
  Butterworth(Pass pass, double cutoff, double dt, const T& start)
      : x1_(start), x2_(start), y1_(start), y2_(start) {
    const double w = std::tan(std::numbers::pi * cutoff * dt);
    const double d = 1 + std::numbers::sqrt2 * w + w * w;
    b0_ = (pass == Pass::kLow ? w * w : 1) / d;
    b1_ = pass == Pass::kLow ? 2 * b0_ : -2 * b0_;
    a1_ = 2 * (w * w - 1) / d;
    a2_ = (1 - std::numbers::sqrt2 * w + w * w) / d;
    if (pass == Pass::kHigh) y1_ = y2_ = start - start;
  }
  T Update(const T& x) {
    const T y = b0_ * (x + x2_) + b1_ * x1_ - a1_ * y1_ - a2_ * y2_;
    x2_ = x1_;
    x1_ = x;
    y2_ = y1_;
    y1_ = y;
    return y;
  }

 private:
  double b0_ = 1, b1_ = 0, a1_ = 0, a2_ = 0;
  T x1_, x2_, y1_, y2_;
};

}  // namespace predictor
