// The revised NIOSH lifting equation. It gives the recommended weight limit, the lifting index and
// the composite lifting index of manual lifts with two hands.
//
// Source: Waters, Putz-Anderson & Garg, Applications Manual for the Revised NIOSH Lifting Equation,
// publication 94-110 (1994, revised 2021; public domain). The formulas, the limits and the whole
// frequency table are verified. Only the metric form is implemented. The manual's form in inches
// and pounds gives slightly different limits for the same lift.
//
// The equation is not valid for lifts with one hand, sitting, kneeling, carrying, pushing, unstable
// loads, motion faster than about 0.75 m/s, slippery floors, heat, or shifts of more than 8 h. The
// equation is defined for lifts "without mechanical assistance" (see AssistedLift).
#pragma once

#include <span>

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

inline constexpr double kLoadConstant = 23;  // [kg] limit under optimal conditions

// The duration of continuous lifting, and the duration of the light work that must follow.
enum class LiftDuration {
  kShort,     // at most 1 h, then at least the same time for recovery
  kModerate,  // at most 2 h, then at least 0.3 times as long for recovery
  kLong,      // at most 8 h, with the usual breaks
};

// The point at which the hands hold the load, which is between the third knuckles.
struct HandPlace {
  double horizontal = 0;  // [m] from the midpoint between the ankles
  double height = 0;      // [m] above the floor
  double asymmetry = 0;   // [rad] angle of the load from the person's sagittal plane, to either
                          // side
};

struct LiftTask {
  double mean_load = 0;  // [kg]
  double max_load = 0;   // [kg]; used only in the composite index
  HandPlace origin, destination;
  // True if the person must regrasp, hold or carefully place the load at the destination. In this
  // case, the limit at the destination counts as well.
  bool controlled_at_destination = false;
  double frequency = 0;  // [1/min] mean over 15 minutes
  LiftDuration duration = LiftDuration::kShort;
  Coupling coupling = Coupling::kGood;  // kUnacceptable counts as kPoor
};

// Factors of the weight limit, each from 0 to 1. A factor of 0 means that the lift is outside the
// equation's range and that no load is recommended.
struct LiftMultipliers {
  double horizontal = 0, vertical = 0, distance = 0, asymmetry = 0, frequency = 0, coupling = 0;
  // Returns the weight limit for a single lift, which does not include the frequency multiplier
  // [kg].
  double FrequencyIndependentLimit() const {
    return kLoadConstant * horizontal * vertical * distance * asymmetry * coupling;
  }
  double Limit() const { return FrequencyIndependentLimit() * frequency; }  // [kg]
};

struct LiftAssessment {
  LiftMultipliers origin, destination;
  double limit = 0;             // [kg] RWL: the lower one, if the destination counts
  double index = 0;             // LI = mean load / limit; infinite if the limit is 0
  bool by_destination = false;  // the destination determines the limit
};

// This does not allocate.
LiftAssessment AssessLift(const LiftTask& task);

// Returns a frequency multiplier from table 5 of the manual. The height is the height of the hands
// at the origin, even for the limit at the destination. Between the rows, the value is interpolated
// linearly. Above the last row that is not 0, the value is 0, because the manual does not state how
// to interpolate towards 0. Frequencies below 0.2 count as 0.2.
double FrequencyMultiplier(double per_minute, LiftDuration duration, double height_at_origin);

// Returns the composite lifting index (CLI) of a job with several tasks. The frequencies of the
// tasks add up. For the sum of the frequencies, the lowest multiplier among the heights and
// durations of these tasks is used. This is a design choice, because the manual does not specify
// it. The CLI is infinite if a limit is 0, and 0 if there are no tasks.
double CompositeLiftingIndex(std::span<const LiftTask> tasks);

// A lift that a cobot assists. NIOSH's equation assumes that the person carries the whole load. The
// first assessment uses only the mass that the person carries. Therefore, every text about this
// assessment must show the label of the assessment.
struct AssistedLift {
  LiftAssessment carried;     // adapted: mass = mean vertical force of both hands / g
  LiftAssessment unassisted;  // the same lift without assistance: the person carries the whole mass
  static constexpr const char* kCarriedLabel = "adapted, not NIOSH";
};

// `whole` describes the lift without help. `mean_vertical_force` [N] is the vertical force that
// both hands together exert on the load, averaged over the lift. Upward forces are positive.
AssistedLift AssessAssistedLift(const LiftTask& whole, double mean_vertical_force);

}  // namespace predictor::ergonomics
