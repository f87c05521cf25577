// Faults in the emulation. After them, only the arms can be judged.
#pragma once

#include <vector>

#include "devices/faults.h"

namespace predictor {

std::vector<Fault> FaultsOfScenes();

}  // namespace predictor
