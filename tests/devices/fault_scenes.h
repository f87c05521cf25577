// Faults in the emulation. After such a fault, the test can judge only the arms.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

std::vector<Fault> FaultsOfScenes();

}  // namespace predictor
