// Finds the keys in which two scenarios differ.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

struct KeyDifference {
  std::string key;   // "handles.left.xyz"
  std::string a, b;  // values as YAML in one line; empty: the scenario does not have the key
};

// Returns the keys with different values, in the order of scenario a, and then the keys that only
// scenario b has. Values that a scenario does not state have their defaults. The name of the
// scenario does not count.
std::vector<KeyDifference> DifferentKeys(const Scenario& a, const Scenario& b);

}  // namespace predictor
