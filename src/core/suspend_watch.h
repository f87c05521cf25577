// Detects that the computer was suspended. While the computer is suspended, CLOCK_MONOTONIC stops,
// but CLOCK_BOOTTIME continues. Ages that are measured with CLOCK_MONOTONIC are therefore too small
// afterwards.
#pragma once

#include <algorithm>
#include <cstdint>

namespace predictor {

class SuspendWatch {
 public:
  // Returns a lower bound of the time for which the computer was suspended since the last call
  // [ns], or 0 if the computer was not suspended. `boot` is the reading of CLOCK_BOOTTIME. `before`
  // and `after` are readings of CLOCK_MONOTONIC that were taken before and after the reading of
  // `boot` [ns]. The difference between the clocks is between boot − after and boot − before, even
  // if the thread was delayed between the readings.
  std::int64_t Look(std::int64_t before, std::int64_t boot, std::int64_t after) noexcept {
    constexpr std::int64_t kRounding = 1'000'000;  // shorter than any suspend [ns]
    const std::int64_t least = boot - after, most = boot - before;
    const bool suspended = known_ && least > most_ + kRounding;
    const std::int64_t time = suspended ? least - most_ : 0;
    most_ = known_ && !suspended ? std::min(most_, most) : most;
    known_ = true;
    return time;
  }

 private:
  bool known_ = false;
  std::int64_t most_ = 0;  // largest possible difference of the clocks [ns]
};

}  // namespace predictor
