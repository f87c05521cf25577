// What one key alone cannot show to be wrong.
#pragma once

#include "scenario/problems.h"
#include "scenario/scenario.h"

namespace predictor {

// Reports contradictions between the parts of a scenario whose single values are all allowed.
// `root` is the tree that it was read from, for the places.
void CheckScenario(const Scenario& scenario, const YamlNode& root, Problems* problems);

}  // namespace predictor
