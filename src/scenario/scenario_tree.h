// A scenario between structs and text.
#pragma once

#include "scenario/problems.h"
#include "scenario/scenario.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// Reads every field of a group of keys and reports what is wrong with single values. What stays
// unsaid or wrong keeps its default.
Scenario ReadFields(const YamlNode& root, Problems* problems);

// The tree that is saved, every default in it and each key with its comment.
YamlNode ScenarioTree(const Scenario& scenario);

}  // namespace predictor
