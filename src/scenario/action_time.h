// How long the actions of a script take: one answer for who plays them and who checks them.
#pragma once

#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// In which a circle's speed rises, and in which it falls [s].
double CircleRamp(const ActionSpec& action) noexcept;

// From an action's start to its end, at a person's average pace [s]: a circle's cycles and, since
// its speed rises and falls, one ramp more; a push's rise, force and fall; else `duration`.
double ActionTime(const ActionSpec& action) noexcept;

// What a person at the handles is to do at `run_time` [s]: the place in the script of the action
// that goes on, the last one begun; -1: none.
int ActionAt(const std::vector<ActionSpec>& script, double run_time) noexcept;

}  // namespace predictor
