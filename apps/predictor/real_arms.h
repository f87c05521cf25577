// Requirements on this computer before real arms are moved.
#pragma once

#include "scenario/machine.h"

namespace predictor {

// A loop that any other program may delay must not move real arms: throws DeviceError if the system
// grants no real-time scheduling. For fakes on this computer, only prints a warning.
void RequireRealTime(const Machine& machine);

// A haptic loop for which a growing oscillation in the scenario's hands is predicted must not move
// real arms: throws InputError. `scenario`: with the machine's arms.
void RequireStability(const Machine& machine, const Scenario& scenario);

}  // namespace predictor
