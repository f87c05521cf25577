// Connects to the real device that a machine file describes.
#pragma once

#include <memory>

#include "devices/real_device.h"
#include "scenario/machine.h"

namespace predictor {

// The purpose of a connection to an arm.
enum class ArmUse {
  kMove,    // the arm accepts our commands
  kListen,  // the arm is only read; a person may move it by free-drive
};

// Connects to the arm or the sensor of one hand. Throws DeviceError. The sensor is null if the arm
// has its own.
std::unique_ptr<Arm> ConnectArm(const MachineArm& side, ArmUse use, Network* network);
std::unique_ptr<WrenchSensor> ConnectSensor(const MachineArm& side, Network* network);

// Connects to the arms and sensors of the hands in `scenario`, which must already include the
// machine file. Reduces the joint velocities and accelerations in `scenario` to the limits of the
// drivers. If a driver limited a single joint during the run, the handle would leave its path.
// Throws DeviceError, whose text names the faulty device and the remedy.
std::unique_ptr<RealDevice> ConnectMachine(const Machine& machine, Scenario* scenario,
                                           std::unique_ptr<Network> network);

}  // namespace predictor
