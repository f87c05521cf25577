// Compares the payload configured in an arm's controller with the calibrated handle.
#pragma once

#include <string>

#include "devices/arm.h"
#include "scenario/machine.h"

namespace predictor::commissioning {

// Describes a difference and the values to enter at the pendant; "" if the payloads agree or the
// arm does not report its payload. The flange carries the handle of the machine file and possibly a
// separate sensor of unknown mass. The payload may therefore be heavier by up to a sensor's weight,
// with its centre shifted accordingly towards the flange. If the arm subtracts that payload from
// its own wrench, only one of the two may have a weight.
std::string PayloadRefusal(const DeviceFacts& facts, const MachineArm& arm);

}  // namespace predictor::commissioning
