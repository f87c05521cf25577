// The payload that an arm's controller was told of, against the handle as it was calibrated.
#pragma once

#include <string>

#include "devices/arm.h"
#include "scenario/machine.h"

namespace predictor {

// What does not fit, and what to enter at the pendant; "" if it fits or the arm does not tell. What
// hangs on the flange is the handle, in the machine file, and a sensor of its own, whose mass
// nobody knows here: then the payload may be heavier, up to a sensor's weight, and its centre where
// that weight, near the flange, can have moved it. Of an arm that takes
// that payload off its own wrench only one of the two may have a weight.
std::string PayloadRefusal(const DeviceFacts& facts, const MachineArm& arm);

}  // namespace predictor
