// Describes the scene in a recording, for Foxglove.
#pragma once

#include <vector>

#include "recording/header.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns "/tf" and "/scene" in Foxglove's schemas. `object_start` is the position of O in W at the
// start [m]. Throws InputError.
std::vector<JsonChannel> RecordedScene(const Scenario& scenario, const Vector3& object_start);

}  // namespace predictor
