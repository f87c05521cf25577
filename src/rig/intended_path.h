// The motion of the object that a script intends. It is the operator's reference, without hands or
// cobot.
#pragma once

#include <vector>

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

struct IntendedSample {
  double time = 0;             // time of the run [s]
  Pose X_WO;                   // intended pose of the object
  Twist V_WO = Twist::Zero();  // intended velocity of the object
  bool held = false;           // whether any hand holds the object
};

// The behaviour of an object that no hand holds. Without a simulation, only the two extreme cases
// of this behaviour can be computed.
enum class AfterRelease {
  kStays,    // stays where it was released
  kReturns,  // returns smoothly to its start until a hand grips it again or the run ends
};

// Returns the object's intended motion from X_WO (its start) at the script's average pace, sampled
// every `step` [s] for the scenario's duration. Throws InputError if the script is invalid.
std::vector<IntendedSample> IntendedPath(const Scenario& scenario, const Pose& X_WO,
                                         AfterRelease after, double step);

// Returns whether a hand grips the object again after all hands have released it. The motion of the
// released object matters only in this case.
bool GripsAgain(const Scenario& scenario);

}  // namespace predictor
