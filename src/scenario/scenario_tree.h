// Converts between a scenario's structs and its tree.
#pragma once

#include "scenario/problems.h"
#include "scenario/scenario.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// Reads every field of a group of keys and reports invalid values. A member with a missing or
// invalid value keeps its default.
Scenario ReadFields(const YamlNode& root, Problems* problems);

// The tree to be saved, with every default and a comment for each key.
YamlNode ScenarioTree(const Scenario& scenario);

}  // namespace predictor
