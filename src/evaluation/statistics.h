// Computes running statistics without storing the samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace predictor {

// Computes the mean, the standard deviation (denominator n − 1) and the largest value with
// Welford's method.
class Statistics {
 public:
  void Add(double x) {
    ++n_;
    const double d = x - mean_;
    mean_ += d / static_cast<double>(n_);
    m2_ += d * (x - mean_);
    max_ = n_ == 1 ? x : std::max(max_, x);
  }
  std::uint64_t count() const { return n_; }
  double mean() const { return mean_; }
  double std() const { return n_ > 1 ? std::sqrt(m2_ / static_cast<double>(n_ - 1)) : 0; }
  double max() const { return max_; }

 private:
  std::uint64_t n_ = 0;
  double mean_ = 0, m2_ = 0, max_ = 0;
};

}  // namespace predictor
