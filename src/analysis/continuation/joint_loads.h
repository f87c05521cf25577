// Computes the load on the operator's joints at the largest force of each continued run.
#pragma once

#include "analysis/continuation/continuation.h"

namespace predictor {

// Sets joint_use of all runs, or no_joint_use. The posture is the nominal posture that reaches both
// handles at that time. The body counts as being at rest.
void AddJointLoads(const StoppedRun& stopped, int workers, Continuation* c);

}  // namespace predictor
