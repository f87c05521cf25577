// Requirements on this computer before real arms are moved.
#pragma once

#include <array>
#include <memory>

#include "models/robot.h"
#include "scenario/machine.h"

namespace predictor {

// The models of a machine's arms. The model is null for an arm that the machine does not have.
using ArmModels = std::array<std::shared_ptr<const RobotModel>, kHands>;

// Reads the models from their files. Call this function before a device is connected. If a file
// stops the program, no arm may be under the program's control. Throws InputError with the machine
// file's line.
ArmModels LoadArmModels(const Machine& machine);

// Throws DeviceError if the system grants no real-time scheduling, because a loop that other
// programs may delay must not move real arms. For fake devices on this computer, the function only
// prints a warning.
void RequireRealTime(const Machine& machine);

// Throws InputError if the prediction for the scenario's hands is a growing oscillation, because
// such a haptic loop must not move real arms. `scenario` contains the machine's arms.
void RequireStability(const Machine& machine, const Scenario& scenario);

// Before real arms displace a person's handles (`perturbation`), the person at the console must
// type "yes". Throws InputError otherwise.
void ConfirmPerturbation(const Scenario& scenario);

}  // namespace predictor
