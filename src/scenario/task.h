// The task that a scenario sets for a person, independent of the system used to perform it.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// Returns the parts in which the tasks of two scenarios differ, as text ("the object"). If the
// tasks are the same, the list is empty.
std::vector<std::string> TaskDifferences(const Scenario& a, const Scenario& b);

}  // namespace predictor
