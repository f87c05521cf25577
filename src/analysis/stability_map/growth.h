// Measures in simulation whether a small disturbance of a scenario's haptic loop grows.
//
// The scenario is simulated twice with the same noise. In both runs, the hands grip and hold the
// handles. In one run, the hands also tap the handles. The effect of the tap is the difference of
// the two motions. This effect follows the loop's linear dynamics without noise, so it either
// decays or grows.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

// The effects that make the loop nonlinear. While one of these effects acts, the prediction is not
// valid.
enum class Limiting : int {
  kCoupling,      // the real handles lag by more than the coupling's dead band
  kSpeed,         // a handle at its speed cap
  kAcceleration,  // a joint's command at its acceleration limit
  kGrip,          // the hand at its maximum strength
  kRendering,     // the QP is relaxed or failed, or the guard changed its command
  kSensor,        // the force sensor saturated
  kPosture,       // the object is more than 20 mm or 0.1 rad from its start
};
inline constexpr int kLimitings = 7;
const char* Name(Limiting limiting);  // as text, for example "the coupling"

struct Growth {
  bool grows = false;
  std::optional<double> rate;  // growth rate of the difference [1/s]; empty: limits acted from the
                               // start
  double frequency = 0;        // of the strongest line in its spectrum [Hz]; 0: unknown
  double time = 0;             // simulated time after the tap [s]
  // The share of the ticks in which each limit acts, in the run without a tap and after the tap in
  // the other run.
  std::array<double, kLimitings> limited = {};
  std::string stopped;  // cause of a stop, if any
};

inline constexpr double kGrowthTime = 11;  // time simulated after the tap has faded [s]

// Returns the scenario for a measurement with the simulated rig: the hands grip and hold and, if
// `tap` is true, tap the handles. Every threshold of `safety` that would stop the run has the
// highest value that a scenario may have. `lead` [s] replaces `auto`.
Scenario HoldScenario(const Scenario& scenario, double lead, bool tap);

// Throws InputError if a model is invalid or the start is out of reach.
Growth MeasureGrowth(const Scenario& scenario, double lead, double time = kGrowthTime);

}  // namespace predictor
