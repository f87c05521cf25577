// The Liberty Mutual equations for manual materials handling (LM-MMH). They give the load or force
// that a share of women or men accepts for a working day.
//
// Source: Potvin, Ciriello, Snook, Maynard & Brogmus 2021, Ergonomics 64, 955–970. Two public
// transcriptions in one repository and our recollection agree with these constants (verified).
// There is one exception: for the sustained push of men, one transcription has 0.6687 instead of
// 0.6887. Only 0.6887 gives a factor of 1 under the reference condition. All other factors are also
// 1 under this condition (tested). The paper itself was not available.
//
// The method is not suitable for work with one hand or for sitting. The method is also not suitable
// for judging injury risk, because its limits are loads that people found acceptable, not loads
// that tissue can bear.
#pragma once

#include "core/sex.h"

namespace predictor::ergonomics {

// The normal distribution of the loads that people accept.
struct Acceptable {
  double mean = 0;       // [kg] for lift, lower and carry, [N] for push and pull
  double variation = 0;  // standard deviation / mean
  bool outside = false;  // an input was outside the range of the study and was limited to it

  // Returns the load that this share of people accepts. The load is at least 0. ForShare(0.75) is
  // the usual design limit.
  double ForShare(double share) const;
  // Returns the share of people, 0 … 1, who accept this load.
  double ShareThatAccepts(double load) const;
};

struct VerticalHandling {
  double reach = 0;  // [m] H, horizontal distance of the hands from the ankles. Women 0.20 … 0.68,
                     // men 0.25 … 0.73
  double mid_height = 0;  // [m] mean of the first and the last height of the hands
  double travel = 0;      // [m] vertical, at least 0.25
  double frequency = 0;   // [1/min] 1/480 … 20
};
Acceptable AcceptableLift(const VerticalHandling& task, Sex sex);
Acceptable AcceptableLower(const VerticalHandling& task, Sex sex);

inline constexpr double kShortestHorizontal = 2.1;  // [m] shorter distances were not studied
struct HorizontalHandling {
  double hand_height = 0;  // [m]
  double distance = 0;     // [m] at least kShortestHorizontal
  double frequency = 0;    // [1/min] 1/480 … 20
};
enum class ForcePhase {
  kInitial,    // the force that sets the object in motion
  kSustained,  // the force that keeps the object moving
};
Acceptable AcceptablePush(const HorizontalHandling& task, ForcePhase phase, Sex sex);
Acceptable AcceptablePull(const HorizontalHandling& task, ForcePhase phase, Sex sex);
Acceptable AcceptableCarry(const HorizontalHandling& task, Sex sex);

}  // namespace predictor::ergonomics
