// Measures the duration of each stage of a tick.
#pragma once

#include <array>
#include <chrono>

#include "core/record.h"

namespace predictor {

class StageTimer {
 public:
  void Start() noexcept { start_ = lap_ = Clock::now(); }
  // Ends `stage`. The time since the previous call is attributed to this stage.
  void Lap(Stage stage) noexcept {
    const Clock::time_point now = Clock::now();
    us_[static_cast<std::size_t>(stage)] = Microseconds(now - lap_);
    lap_ = now;
  }
  // Writes the times of all stages and of the whole tick [µs].
  void Finish(std::array<float, kStages>* us) noexcept {
    us_[static_cast<std::size_t>(Stage::kTick)] = Microseconds(Clock::now() - start_);
    *us = us_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static float Microseconds(Clock::duration d) {
    return std::chrono::duration<float, std::micro>(d).count();
  }
  Clock::time_point start_, lap_;
  std::array<float, kStages> us_{};
};

}  // namespace predictor
