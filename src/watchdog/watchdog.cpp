#include "watchdog/watchdog.h"

namespace predictor::watchdog {
bool Watchdog::Look(std::uint64_t ticks, RunState state, std::uint64_t now) noexcept {
  if (ticks != ticks_ || since_ == 0) {
    ticks_ = ticks;
    since_ = now;
    barked_ = false;
    return false;
  }
  if (barked_ || !MayMove(state) || now - since_ < kPatience) return false;
  return barked_ = true;
}

}  // namespace predictor::watchdog
