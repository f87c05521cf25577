// A scenario as the tree that is saved, shared by saving and the schema's defaults.
#pragma once

#include "scenario/scenario.h"
#include "scenario/yaml_tree.h"

namespace predictor {

YamlNode ScenarioTree(const Scenario& scenario);

}  // namespace predictor
