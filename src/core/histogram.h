// Estimates quantiles without storing the samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace predictor {

// Estimates quantiles of positive values from 0.01 to 1e7. Uses logarithmic buckets, each 1 % wide.
class Histogram {
 public:
  void Add(double x) {
    ++n_;
    max_ = std::max(max_, x);
    const double b = std::log(std::max(kLowest, x) / kLowest) / kWidth;  // NaN counts as kLowest
    ++counts_[static_cast<std::size_t>(std::min(b, kBuckets - 1.0))];
  }
  // Returns the value below which a fraction p of the samples lies.
  double Quantile(double p) const {
    if (n_ == 0) return 0;
    const double rank = p * static_cast<double>(n_);
    double sum = 0;
    for (std::size_t b = 0; b < kBuckets; ++b) {
      sum += static_cast<double>(counts_[b]);
      if (sum >= rank)
        return std::min(max_, kLowest * std::exp((static_cast<double>(b) + 0.5) * kWidth));
    }
    return max_;
  }
  double max() const { return max_; }
  std::uint64_t count() const { return n_; }

 private:
  static constexpr double kLowest = 0.01;
  static constexpr double kWidth = 0.01;
  static constexpr std::size_t kBuckets = 2073;  // ln(1e9) / width
  std::array<std::uint32_t, kBuckets> counts_{};
  std::uint64_t n_ = 0;
  double max_ = 0;
};

}  // namespace predictor
