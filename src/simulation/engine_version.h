// Returns the versions of the physics engines.
#pragma once

#include <string>

#include "scenario/scenario.h"

namespace predictor {

// Returns "MuJoCo 4.0.0" or "DART 6.12.1", or "" if this build lacks DART. For DART, the function
// starts a process and waits for its answer.
std::string EngineVersion(EngineKind engine);

}  // namespace predictor
