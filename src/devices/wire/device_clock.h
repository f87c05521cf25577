// How old is what a device has sent, by the device's own time-stamps, or a counter of its own.
#pragma once

#include <algorithm>
#include <cstdint>

namespace predictor {

// The quickest package of late tells what the device's clock shows here; one that took longer is
// older by as much. The part that every package takes cannot be seen.
class DeviceClock {
 public:
  // By which two clocks may drift apart: far more than quartz does, far less than a network that
  // holds packages back.
  static constexpr double kDrift = 5e-4;

  explicit DeviceClock(double drift = kDrift) : drift_(drift) {}

  // A package with this time-stamp [s] arrives now [ns]. Time-stamps rise.
  void Arrived(double stamp, std::uint64_t now) noexcept {
    if (start_ == 0) start_ = now;
    const double offset = Seconds(now) - stamp;
    offset_ = known_ ? std::min(offset, offset_ + drift_ * (stamp - stamp_)) : offset;
    stamp_ = stamp;
    known_ = true;
  }
  // Of that package [s].
  double Age(std::uint64_t now) const noexcept {
    return known_ ? std::max(0.0, Seconds(now) - stamp_ - offset_) : 1e9;
  }

 private:
  double Seconds(std::uint64_t now) const noexcept {
    return 1e-9 * static_cast<double>(now - start_);
  }

  double drift_;
  std::uint64_t start_ = 0;
  double stamp_ = 0, offset_ = 0;
  bool known_ = false;
};

}  // namespace predictor
