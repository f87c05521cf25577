// What a scenario asks of a person, apart from the system that the person does it with.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// The parts in which two scenarios set different tasks, in words ("the object"); empty: one task.
std::vector<std::string> TaskDifferences(const Scenario& a, const Scenario& b);

}  // namespace predictor
