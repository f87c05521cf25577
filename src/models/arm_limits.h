// The joint limits of a device arm that rendering and the guard apply.
#pragma once

#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Each list of limits has one entry per joint. The limits are positions [rad], velocities [rad/s]
// and accelerations [rad/s²]. The velocity limit is 80 % of the vendor's limit unless the scenario
// sets a lower one.
struct ArmLimits {
  JointVector lower, upper, velocity, acceleration;
};

// Throws InputError at the key of a list whose length differs from the number of joints.
ArmLimits LimitsOf(const ArmSpec& spec, const RobotModel& model);

}  // namespace predictor
