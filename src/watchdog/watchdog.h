// Detects whether the control loop hangs.
#pragma once

#include <cstdint>

#include "core/status.h"

namespace predictor::watchdog {

class Watchdog {
 public:
  // If no tick occurs for this time [ns] while the arms may move, the control loop is regarded as
  // hanging.
  static constexpr std::uint64_t kPatience = 10'000'000;

  // Call this function at least every millisecond. `ticks` is the number of ticks published so far.
  // `state` is the state in the latest tick. `now` is the monotonic clock [ns]. Returns true once
  // for each time that the loop hangs. The caller must then stop the arms.
  bool Look(std::uint64_t ticks, RunState state, std::uint64_t now) noexcept;

 private:
  std::uint64_t ticks_ = 0;
  std::uint64_t since_ = 0;  // time of the latest new tick [ns]
  bool barked_ = false;
};

}  // namespace predictor::watchdog
