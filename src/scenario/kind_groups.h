// Finds the parts of a scenario whose keys depend on their kind. A word in each part names its
// kind.
#pragma once

#include <vector>

#include "scenario/own_parameters.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// Returns the groups that exist in the tree of a scenario: the cobot's controller and the entries
// of the operator's script. They point into `root`.
std::vector<KindGroup> KindGroups(YamlNode* root);

}  // namespace predictor
