// Writes sentences about the cobot's controller and the remedies that exist for this controller.
#pragma once

#include <string>

#include "analysis/check/check.h"

namespace predictor {

// Returns sentences that state at which joint the controller is unstable, why, and what to change.
std::string ControllerProblem(const Scenario& scenario, const CheckReport& report);

// Returns the beginning of a sentence that explains how to end the oscillation of a cobot with its
// load, for example "Raise cobot.controller.damping_ratio, use a heavier object,".
std::string MoreDamping(const CobotSpec& cobot);

}  // namespace predictor
