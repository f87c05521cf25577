// Finds events of a scenario that cannot begin in its run.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns a sentence for each event whose trigger asks for a time after the end of the run, or for
// a place that the object does not reach on the path of the operator's script. X_WO is the object's
// pose at the start. Only the virtual operator has a path. Throws InputError if the script is
// invalid.
std::vector<std::string> EventWarnings(const Scenario& scenario, const Pose& X_WO);

}  // namespace predictor
