// Compares the data that an arm reports when connecting with the arm's description in the machine
// file.
#pragma once

#include <string>

#include "devices/arm.h"
#include "models/robot.h"
#include "scenario/machine.h"

namespace predictor::commissioning {

// Allowed difference between the reported and the modelled pose. This value is larger than the
// calibration differences of most arms, but smaller than the difference between any two models of
// Universal Robots arms. (A Panda and a Research 3 have the same links.)
inline constexpr double kFlangeSlack = 0.005;    // [m]
inline constexpr double kFlangeRotation = 0.02;  // [rad]

// Returns a text that describes a difference in the poses and the remedy. Returns "" if the poses
// agree or the arm does not report its pose. The base of a model may be rotated by half a turn
// about z from the manufacturer's base, as in UR models. The flange is the link that has the
// manufacturer's name for the flange. In a model without such a link, the flange is end_effector.
std::string KinematicsRefusal(const DeviceFacts& facts, const ArmSpec& arm,
                              const RobotModel& model);

// Returns a text that describes a difference in the payloads and the values to enter at the
// pendant. Returns "" if the payloads agree or the arm does not report its payload. The flange
// carries the handle of the machine file and possibly a separate sensor of unknown mass. The
// payload may therefore be heavier by up to a sensor's weight, with its centre shifted accordingly
// towards the flange. The arm may subtract the payload of its controller from its own wrench. In
// this case, either this payload or the handle in the machine file must have no weight.
std::string PayloadRefusal(const DeviceFacts& facts, const MachineArm& arm);

}  // namespace predictor::commissioning
