// Whether a small disturbance of a scenario's haptic loop grows, measured in simulation.
//
// The scenario is simulated twice with the same noise: both hands grip and hold, and in one of the
// two runs they tap the handles besides. What the tap changes, the difference of the two motions,
// obeys the loop's linear dynamics without the noise: it decays or it grows.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

// What makes the loop other than linear. While one of them acts, the prediction says nothing.
enum class Limiting : int {
  kCoupling,      // the real handles lag by more than the coupling's deadband
  kSpeed,         // a handle at its speed cap
  kAcceleration,  // a joint's command at its acceleration limit
  kGrip,          // the hand as strong as it can be
  kRendering,     // the QP relaxed or failed, or the guard altered its command
  kSensor,        // the force sensor saturated
  kPosture,       // the object farther than 20 mm or 0.1 rad from where it started
};
inline constexpr int kLimitings = 7;
const char* Name(Limiting limiting);  // in words, as "the coupling"

struct Growth {
  bool grows = false;
  std::optional<double> rate;  // of the difference [1/s]; none: the limits came at once
  double frequency = 0;        // of the strongest line in its spectrum [Hz]; 0: unknown
  double time = 0;             // for which it was simulated after the tap [s]
  // Share of the ticks without a tap, and after it, in which each acts.
  std::array<double, kLimitings> limited = {};
  std::string stopped;  // cause of a stop, if there was one
};

inline constexpr double kGrowthTime = 11;  // simulated after the tap has faded [s]

// The scenario as it is held for a measurement: hands that grip and only hold (or tap as well), the
// simulated rig, and every threshold of `safety` that would stop the run as high as a scenario may
// have it. `lead` [s] replaces `auto`.
Scenario HoldScenario(const Scenario& scenario, double lead, bool tap);

// Throws InputError (models, a start out of reach).
Growth MeasureGrowth(const Scenario& scenario, double lead, double time = kGrowthTime);

}  // namespace predictor
