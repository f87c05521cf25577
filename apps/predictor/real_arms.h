// What is asked of this computer before real arms are moved.
#pragma once

#include "scenario/machine.h"

namespace predictor {

// Real arms do not move by a loop that any other program may hold up: throws DeviceError where the
// system gives no real-time scheduling. Fakes on this computer are moved all the same: a warning.
void RequireRealTime(const Machine& machine);

// Real arms are not moved by a loop that is predicted to swing more and more in the scenario's own
// hands: throws InputError. `scenario`: with the machine's arms.
void RequireStability(const Machine& machine, const Scenario& scenario);

}  // namespace predictor
