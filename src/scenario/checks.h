// Finds errors that are not visible in a single key.
#pragma once

#include "scenario/problems.h"
#include "scenario/scenario.h"

namespace predictor {

// Reports contradictions between parts of a scenario whose individual values are all allowed.
// `root` is the tree from which the scenario was read. It supplies the places for the messages.
void CheckScenario(const Scenario& scenario, const YamlNode& root, Problems* problems);

}  // namespace predictor
