// Measures how long a sender of heartbeats has been silent.
#pragma once

#include <cstdint>

namespace predictor {

class Heartbeat {
 public:
  // Returns the time since the count of heartbeats last changed [s]. `beats` is the count so far,
  // and `now` is the monotonic clock [ns]. This class trusts neither the sender's clock nor its
  // count.
  double Silence(std::uint32_t beats, std::uint64_t now) noexcept {
    if (!known_ || beats != beats_) {
      known_ = true;
      beats_ = beats;
      since_ = now;
    }
    return 1e-9 * static_cast<double>(now - since_);
  }

 private:
  bool known_ = false;
  std::uint32_t beats_ = 0;
  std::uint64_t since_ = 0;  // [ns]
};

}  // namespace predictor
