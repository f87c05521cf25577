// Sees that the loop hangs.
#pragma once

#include <cstdint>

#include "core/status.h"

namespace predictor {

class Watchdog {
 public:
  // Without a tick for so long while arms may move, the loop hangs [ns].
  static constexpr std::uint64_t kPatience = 10'000'000;

  // At least every millisecond: how many ticks were published, the state that the last told, and
  // the monotonic clock [ns]. True, once for each time that it hangs: the arms must be stopped.
  bool Look(std::uint64_t ticks, RunState state, std::uint64_t now) noexcept;

 private:
  std::uint64_t ticks_ = 0;
  std::uint64_t since_ = 0;  // of the last new tick [ns]
  bool barked_ = false;
};

}  // namespace predictor
