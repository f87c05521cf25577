// Estimates the offset between the clocks of two measurements of the same hand.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor::tracks {

// The positions of a point over time. A missing position is NaN. Times ascend [s].
struct Path {
  std::span<const double> times;
  std::span<const Vector3> p;  // in any frame at rest [m]
};

struct ClockOffset {
  double offset = 0;       // to be added to the times of `track` to get those of `reference` [s]
  double uncertainty = 0;  // half of the 95 % interval [s]
  double correlation = 0;  // correlation of the speeds at this offset
};

// Estimates the offset from the speeds, which do not depend on the frames. The normalised
// cross-correlation of the speeds has its maximum at the offset. The offsets of eight parts of the
// record give its uncertainty (a jackknife over blocks, because errors of neighbouring samples are
// not independent).
//
// Throws InputError if the records overlap too little, the hand moves too little, or the best
// correlation is below kMinCorrelation. The message begins with `what`. Also throws InputError if
// the correlation of another offset is at least kMaxSecond times the best one (as for a periodic
// motion), or if the offset changes within the record (because a clock jumps or drifts).
ClockOffset EstimateOffset(const Path& reference, const Path& track, const std::string& what);

// These values are design choices.
inline constexpr double kMinCorrelation = 0.8;
inline constexpr double kMaxSecond = 0.9;
inline constexpr double kMinOverlap = 3;  // [s]
inline constexpr double kMaxDrift = 0.1;  // largest difference between parts of the record [s]

}  // namespace predictor::tracks
