// Computes the age of a robot's state from the robot's own clock.
#pragma once

#include <algorithm>
#include <cstdint>

namespace predictor::fci {

// The age is the delay of a state minus the shortest recent delay. The age of a late state is
// therefore already greater than zero when the state arrives.
class RobotClock {
 public:
  // Reports that a state with this ID (one per millisecond) arrived at `now` [ns].
  void Heard(std::uint64_t id, std::uint64_t now) noexcept {
    if (heard_ == 0) {
      first_id_ = id;
      first_ = now;
    }
    // The two clocks drift, so the estimate of the shortest delay grows slowly until a shorter
    // delay occurs.
    const double drift = heard_ == 0 ? 0 : kDrift * static_cast<double>(now - heard_);
    offset_ = std::min(Offset(id, now), offset_ + drift);
    heard_ = now;
  }
  // Returns the age of the state with this ID at `now` [ns], which is at least 0 [s].
  double Age(std::uint64_t id, std::uint64_t now) const noexcept {
    return std::max(0.0, 1e-9 * (Offset(id, now) - offset_));
  }

 private:
  // Allowed drift between the clocks per second [s].
  static constexpr double kDrift = 5e-4;

  // Returns the offset of this computer's clock relative to the robot's clock, counted from the
  // first state [ns]. The offset is exact for a hundred days, and is finite for every ID that a
  // state may contain.
  double Offset(std::uint64_t id, std::uint64_t now) const noexcept {
    return static_cast<double>(now - first_) -
           1e6 * static_cast<double>(static_cast<std::int64_t>(id - first_id_));
  }

  std::uint64_t first_id_ = 0, first_ = 0, heard_ = 0;
  double offset_ = 0;  // [ns]
};

}  // namespace predictor::fci
