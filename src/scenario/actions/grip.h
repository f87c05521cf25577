// The action that closes and opens hands, which grip, release and put_down use.
#pragma once

#include <array>
#include <string>

#include "scenario/actions/action.h"

namespace predictor {

// Closes or opens hands within `time` [s]. The action takes the same time.
class Grip : public Action {
 public:
  Grip(const std::string& hand, bool hold, double time)
      : concerns_{Concerns(hand, 0), Concerns(hand, 1)}, hold_(hold), time_(time) {}
  void Begin(Intent* intent) noexcept override {
    left_ = time_;
    for (std::size_t i = 0; i < kHands; ++i) {
      if (!concerns_[i]) continue;
      intent->hold[i] = hold_;
      if (hold_) intent->grip_time[i] = time_;
    }
  }
  bool Advance(double dt, double, Intent*) noexcept override { return (left_ -= dt) > 0; }
  void Archive(StateArchive& a) noexcept override { a(left_); }

 private:
  std::array<bool, kHands> concerns_;
  bool hold_;
  double time_;      // [s]
  double left_ = 0;  // [s]
};

}  // namespace predictor
