// Sentences about the cobot's controller, with remedies that this controller has.
#pragma once

#include <string>

#include "analysis/check/check.h"

namespace predictor {

// Says at which joint the controller is unstable, why, and what to change.
std::string ControllerProblem(const Scenario& scenario, const CheckReport& report);

// Returns the beginning of a sentence that ends the oscillation of a cobot with its load: "Raise
// cobot.controller.damping_ratio, use a heavier object,".
std::string MoreDamping(const CobotSpec& cobot);

}  // namespace predictor
