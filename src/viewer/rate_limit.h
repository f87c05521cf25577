// Limits the number of events per second.
#pragma once

#include <algorithm>
#include <cstdint>

namespace predictor::viewer {

// A token bucket that fills at `rate` tokens per second. It holds at most the tokens of a quarter
// of a second, but at least one.
class RateLimit {
 public:
  explicit RateLimit(double rate) : rate_(rate), most_(std::max(1.0, rate / 4)), left_(most_) {}

  // Returns whether another event is allowed now. `now` is the monotonic clock [ns].
  bool Take(std::uint64_t now_ns) {
    if (now_ns > last_ns_) {
      left_ = std::min(most_, left_ + static_cast<double>(now_ns - last_ns_) * 1e-9 * rate_);
      last_ns_ = now_ns;
    }
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }

 private:
  double rate_, most_, left_;
  std::uint64_t last_ns_ = 0;
};

}  // namespace predictor::viewer
