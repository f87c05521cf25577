// A measurement of the head of the person who wears the headset.
#pragma once

#include <array>
#include <cstdint>

namespace predictor {

// The place of W in the headset's space (Z up), as the person registered it: a rotation about the
// vertical and a translation.
struct HeadRegistration {
  double yaw = 0;             // [rad]
  std::array<double, 3> t{};  // origin of W in the headset's space [m]
  double residual = 0;        // root mean square of the residuals of the touched points [m]
  bool operator==(const HeadRegistration&) const = default;
};

struct HeadRecord {
  std::uint64_t wall_ns = 0;  // monotonic clock at the pose, as TickRecord::wall_ns
  double delay = 0;           // time from the pose until the viewer received it [s]
  std::uint64_t client = 0;   // client of the viewer that wears the headset
  // The frame between the eyes in W: x forward, y left, z up.
  std::array<double, 3> p{};               // [m]
  std::array<double, 4> q = {1, 0, 0, 0};  // unit, scalar first
  HeadRegistration registration;
};

inline constexpr double kFarthestHead = 100;       // from the origin of W, on each axis [m]
inline constexpr double kLargestHeadYaw = 10;      // of a registration [rad]
inline constexpr double kWorstHeadResidual = 1;    // of a registration [m]
inline constexpr double kLongestHeadDelay = 0.25;  // [s]
inline constexpr double kLongestHeadLead = 1;      // of a head, ahead of the newest tick [s]

// Returns whether all numbers are finite and within these limits, and `q` is a unit quaternion. A
// record may come from another process or from a file.
bool IsPlausible(const HeadRecord& head);
// Returns whether the head is plausible and at most kLongestHeadLead later than `newest_ns`, the
// monotonic clock at the newest tick. Otherwise, a head from a far future would keep all later
// heads waiting.
bool IsCredible(const HeadRecord& head, std::uint64_t newest_ns);

}  // namespace predictor
