// Faults of our own process, which dies, hangs, or is asked to end.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

std::vector<Fault> FaultsOfProcesses();

}  // namespace predictor
