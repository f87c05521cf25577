// Faults that cannot be injected into a run, or after which only the arms can be judged.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

// Starts RECOVERY instead of a run. Returns false if it is not reached.
bool StartToRecover(Bench& bench);

std::vector<Fault> FaultsOfStarts();     // refused or reported before the run
std::vector<Fault> FaultsOfProcesses();  // our process dies or hangs
std::vector<Fault> FaultsOfScenes();     // in the emulation

}  // namespace predictor
