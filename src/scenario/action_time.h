// How long the actions of a script take: one answer for who plays them and who checks them.
#pragma once

#include "scenario/scenario.h"

namespace predictor {

// In which a circle's speed rises, and in which it falls [s].
double CircleRamp(const ActionSpec& action);

// From an action's start to its end, at a person's average pace [s]: a circle's cycles and, since
// its speed rises and falls, one ramp more; a push's rise, force and fall; else `duration`.
double ActionTime(const ActionSpec& action);

}  // namespace predictor
