// The real device that a machine file describes.
#pragma once

#include <memory>

#include "devices/real_device.h"
#include "scenario/machine.h"

namespace predictor {

// Connects to the arms and sensors of the hands that `scenario` (with the machine applied) has.
// Throws DeviceError: who does not answer as it must, and what to do.
std::unique_ptr<RealDevice> ConnectMachine(const Machine& machine, const Scenario& scenario,
                                           std::unique_ptr<Network> network);

}  // namespace predictor
