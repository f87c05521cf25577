// The arm's model of the machine file, against where the arm itself says that its flange is.
#pragma once

#include <string>

#include "devices/arm.h"
#include "models/robot.h"
#include "scenario/machine.h"

namespace predictor {

// By how much the two may differ: more than most arms' own calibration makes up, less than any two
// arms of Universal Robots do. (A Panda and a Research 3 have the same links.)
inline constexpr double kFlangeSlack = 0.005;    // [m]
inline constexpr double kFlangeRotation = 0.02;  // [rad]

// What does not fit, and what to do; "" if it fits or the arm does not tell. A model's base may be
// turned by half a turn about z from the maker's, as those of UR are. The flange is the link that
// the maker's models name so; a model without it has its end_effector there.
std::string KinematicsRefusal(const DeviceFacts& facts, const ArmSpec& arm,
                              const RobotModel& model);

}  // namespace predictor
