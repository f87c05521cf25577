// Computes the age of a device's data from the device's own time-stamps or counter.
#pragma once

#include <algorithm>
#include <cstdint>

namespace predictor {

// The recent packet with the shortest delay determines the offset of the device's clock. A packet
// with a longer delay is older by the difference between the delays. The delay that is common to
// all packets cannot be observed.
class DeviceClock {
 public:
  // Allowed drift between the clocks. This value is far larger than the drift of quartz clocks, and
  // far smaller than the changing delays of a network.
  static constexpr double kDrift = 5e-4;

  explicit DeviceClock(double drift = kDrift) : drift_(drift) {}

  // Reports that a packet with this time-stamp [s] arrives at `now` [ns]. Time-stamps ascend.
  void Arrived(double stamp, std::uint64_t now) noexcept {
    if (start_ == 0) start_ = now;
    const double offset = Seconds(now) - stamp;
    offset_ = known_ ? std::min(offset, offset_ + drift_ * (stamp - stamp_)) : offset;
    stamp_ = stamp;
    known_ = true;
  }
  // Returns the age of this packet [s].
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
