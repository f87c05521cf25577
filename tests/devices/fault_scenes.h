// Faults that do not come upon a run, or after which nobody is there to judge but the arms.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

// RECOVERY instead of a run; false if it does not come to that.
bool StartToRecover(Bench& bench);

std::vector<Fault> FaultsOfStarts();     // refused, or warned of, before anything runs
std::vector<Fault> FaultsOfProcesses();  // ours that dies or hangs
std::vector<Fault> FaultsOfScenes();     // of what is emulated

}  // namespace predictor
