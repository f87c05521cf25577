// Compares the arm's model in the machine file with the flange pose that the arm itself reports.
#pragma once

#include <string>

#include "devices/arm.h"
#include "models/robot.h"
#include "scenario/machine.h"

namespace predictor::commissioning {

// Allowed difference. It exceeds the calibration differences of most arms but not the difference
// between any two models of Universal Robots arms. (A Panda and a Research 3 have the same links.)
inline constexpr double kFlangeSlack = 0.005;    // [m]
inline constexpr double kFlangeRotation = 0.02;  // [rad]

// Describes a difference and the remedy; "" if the poses agree or the arm does not report its pose.
// A model's base may be turned by half a turn about z from the manufacturer's, as in UR models. The
// flange is the link with the manufacturer's name for it; in a model without such a link it is
// end_effector.
std::string KinematicsRefusal(const DeviceFacts& facts, const ArmSpec& arm,
                              const RobotModel& model);

}  // namespace predictor::commissioning
