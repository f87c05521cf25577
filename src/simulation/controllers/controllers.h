// The available controllers: one line and one file for each.
#pragma once

#include "simulation/controller.h"

namespace predictor {

std::unique_ptr<Controller> MakeCartesianImpedance(const ControllerContext& context);
std::unique_ptr<Controller> MakeGravityCompensation(const ControllerContext& context);
std::unique_ptr<Controller> MakeJointImpedance(const ControllerContext& context);

struct RegisteredController {
  const char* name;  // cobot.controller.type
  ControllerFactory make;
};

inline constexpr RegisteredController kControllers[] = {
    {"cartesian_impedance", MakeCartesianImpedance},
    {"gravity_compensation", MakeGravityCompensation},
    {"joint_impedance", MakeJointImpedance},
};

}  // namespace predictor
