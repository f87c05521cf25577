// Finds errors that concern more than one key.
#pragma once

#include "scenario/problems.h"
#include "scenario/scenario.h"

namespace predictor {

// Reports contradictions between parts of a scenario whose individual values are all allowed.
// `root` is the tree from which the scenario was read. `root` contains the places that the messages
// state.
void CheckScenario(const Scenario& scenario, const YamlNode& root, Problems* problems);

}  // namespace predictor
