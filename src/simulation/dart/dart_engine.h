// Makes DART, the engine of Gazebo's dartsim, available as an engine of the virtual world.
#pragma once

#include <memory>

#include "simulation/engine.h"

namespace predictor {

// As MakeEngine. DART runs in a separate process and in virtual time only, because each step waits
// for this process. A free object cannot be attached: StepMatrix, Forces and AddReactions do not
// describe contacts.
std::unique_ptr<Engine> MakeDartEngine(const Scenario& scenario, const RobotModel& cobot,
                                       Holding holding);

}  // namespace predictor
