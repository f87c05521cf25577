// Declares the faults that the program refuses or reports before the run.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

// Starts RECOVERY instead of a run. Returns false if the arms do not reach RECOVERY.
bool StartToRecover(Bench& bench);

std::vector<Fault> FaultsOfStarts();

}  // namespace predictor
