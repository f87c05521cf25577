// Finds errors that are not visible in a single key.
#pragma once

#include "scenario/problems.h"
#include "scenario/scenario.h"

namespace predictor {

// Reports contradictions between parts of a scenario whose individual values are all allowed.
// `root` is the tree from which it was read; it supplies the places.
void CheckScenario(const Scenario& scenario, const YamlNode& root, Problems* problems);

}  // namespace predictor
