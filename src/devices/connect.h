// The real device that a machine file describes.
#pragma once

#include <memory>

#include "devices/real_device.h"
#include "scenario/machine.h"

namespace predictor {

// What an arm is connected to for.
enum class ArmUse {
  kMove,    // it takes our commands
  kListen,  // it is only read, whoever moves it: a person by its free-drive, or nobody
};

// Of one hand. Throws DeviceError. No sensor (the arm has its own): null.
std::unique_ptr<Arm> ConnectArm(const MachineArm& side, ArmUse use, Network* network);
std::unique_ptr<WrenchSensor> ConnectSensor(const MachineArm& side, Network* network);

// Connects to the arms and sensors of the hands that `scenario` (with the machine applied) has, and
// brings what it says of their joints' velocities and accelerations down to what their drivers let
// through: one joint that was cut while the others are not would lead its handle astray.
// Throws DeviceError: who does not answer as it must, and what to do.
std::unique_ptr<RealDevice> ConnectMachine(const Machine& machine, Scenario* scenario,
                                           std::unique_ptr<Network> network);

}  // namespace predictor
