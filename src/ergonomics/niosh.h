// The revised NIOSH lifting equation: recommended weight limit, lifting index and composite lifting
// index of manual lifts with two hands.
//
// The source is Waters, Putz-Anderson & Garg, Applications Manual for the Revised NIOSH Lifting
// Equation, publication 94-110 (1994, revised 2021; public domain). Formulas, limits and the whole
// frequency table are verified. Only the metric form is implemented. The manual's form in inches
// and pounds gives slightly different limits for the same lift.
//
// The equation is not valid for one hand, sitting, kneeling, carrying, pushing, unstable loads,
// motion faster than about 0.75 m/s, slippery floors, heat, or more than 8 h. The equation is
// defined for lifts "without mechanical assistance"; see AssistedLift.
#pragma once

#include <span>

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

inline constexpr double kLoadConstant = 23;  // [kg] limit under optimal conditions

// The duration of continuous lifting, and the light work that must follow it.
enum class LiftDuration {
  kShort,     // at most 1 h, then at least the same time for recovery
  kModerate,  // at most 2 h, then at least 0.3 times as long for recovery
  kLong,      // at most 8 h, with the usual breaks
};

// Where the hands hold the load (the point between the third knuckles).
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
  // Whether the person must regrasp, hold or carefully place the load at the destination. In this
  // case, the limit at the destination counts as well.
  bool controlled_at_destination = false;
  double frequency = 0;  // [1/min] mean over 15 minutes
  LiftDuration duration = LiftDuration::kShort;
  Coupling coupling = Coupling::kGood;  // kUnacceptable counts as kPoor
};

// Factors of the limit, 0 … 1. A factor of 0 means that the lift is outside the equation's range
// and that no load is recommended.
struct LiftMultipliers {
  double horizontal = 0, vertical = 0, distance = 0, asymmetry = 0, frequency = 0, coupling = 0;
  // Returns the limit for a single lift, without the frequency [kg].
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

// Returns a value of the manual's table 5. The height is the height at the origin, even for the
// limit at the destination. The value is linear between the rows, and 0 above the last row that is
// not 0 (the manual does not state how to interpolate towards 0). Frequencies below 0.2 count as
// 0.2.
double FrequencyMultiplier(double per_minute, LiftDuration duration, double height_at_origin);

// Returns the composite lifting index (CLI) of a job with several tasks. The frequencies of the
// tasks add up. For the sum, the lowest multiplier among the heights and durations of these tasks
// is used (the manual does not specify this; design choice). The CLI is infinite if a limit is 0,
// and 0 if there are no tasks.
double CompositeLiftingIndex(std::span<const LiftTask> tasks);

// A lift that a cobot assists. NIOSH's equation assumes that the person carries the whole load. The
// first assessment uses only the mass that the person carries, so every text about this assessment
// must show its label.
struct AssistedLift {
  LiftAssessment carried;     // adapted: mass = mean vertical force of both hands / g
  LiftAssessment unassisted;  // the same lift without assistance: the person carries the whole mass
  static constexpr const char* kCarriedLabel = "adapted, not NIOSH";
};

// `whole` describes the lift without help. `mean_vertical_force` [N] is the vertical force that
// both hands exert on the load, averaged over the lift, positive upwards.
AssistedLift AssessAssistedLift(const LiftTask& whole, double mean_vertical_force);

}  // namespace predictor::ergonomics
