// Faults of our own process, which dies, hangs, or receives a request to end.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

std::vector<Fault> FaultsOfProcesses();

}  // namespace predictor
