// Where a script wants the object over time: the operator's reference, without hands or cobot.
#pragma once

#include <vector>

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

struct IntendedSample {
  double time = 0;             // of the run [s]
  Pose X_WO;                   // where the object should be
  Twist V_WO = Twist::Zero();  // how it should move there
  bool held = false;           // by any hand
};

// What becomes of an object that nobody holds: without a simulation, one of two extremes.
enum class AfterRelease {
  kStays,    // where it was let go
  kReturns,  // to its start, smoothly, until somebody grips it again or the run ends
};

// The object's intended motion from X_WO (its start), at the script's average pace, every `step`
// [s] of the scenario's duration. Throws InputError if the script is wrong.
std::vector<IntendedSample> IntendedPath(const Scenario& scenario, const Pose& X_WO,
                                         AfterRelease after, double step);

// Whether a hand grips again after all had let go: only then what lies between matters.
bool GripsAgain(const Scenario& scenario);

}  // namespace predictor
