// Computes the duration of a script's actions, both for performing and for checking them.
#pragma once

#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// From an action's start to its end, at an average pace [s].
double ActionTime(const ActionSpec& action) noexcept;

// Index in the script of the action in progress at `run_time` [s], which is the last one that has
// started; −1: none. A person at the handles follows it.
int ActionAt(const std::vector<ActionSpec>& script, double run_time) noexcept;

}  // namespace predictor
