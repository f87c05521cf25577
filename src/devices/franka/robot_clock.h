// How old a robot's state is, by the robot's own clock.
#pragma once

#include <algorithm>
#include <cstdint>

namespace predictor::fci {

// Tells the delay of a state above the shortest one seen: a late state is old when it comes.
class RobotClock {
 public:
  // A state with this id, a millisecond each, was there at `now` [ns].
  void Heard(std::uint64_t id, std::uint64_t now) noexcept {
    if (heard_ == 0) {
      first_id_ = id;
      first_ = now;
    }
    // The two clocks differ, so the shortest delay is forgotten slowly.
    const double drift = heard_ == 0 ? 0 : kDrift * static_cast<double>(now - heard_);
    offset_ = std::min(Offset(id, now), offset_ + drift);
    heard_ = now;
  }
  // Of the state with this id, at `now` [ns]; at least 0 [s].
  double Age(std::uint64_t id, std::uint64_t now) const noexcept {
    return std::max(0.0, 1e-9 * (Offset(id, now) - offset_));
  }

 private:
  // By which clocks may differ, each second [s].
  static constexpr double kDrift = 5e-4;

  // Of our clock above the robot's, since the first state [ns]; exact for a hundred days, and a
  // number whatever a state says that its id is.
  double Offset(std::uint64_t id, std::uint64_t now) const noexcept {
    return static_cast<double>(now - first_) -
           1e6 * static_cast<double>(static_cast<std::int64_t>(id - first_id_));
  }

  std::uint64_t first_id_ = 0, first_ = 0, heard_ = 0;
  double offset_ = 0;  // [ns]
};

}  // namespace predictor::fci
