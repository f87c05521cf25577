// Makes MuJoCo available as an engine of the virtual world.
#pragma once

#include <memory>

#include "simulation/engine.h"

namespace predictor {

// As MakeEngine. Limits of positions are soft, and there are no limits of velocities.
std::unique_ptr<Engine> MakeMujocoEngine(const Scenario& scenario, const RobotModel& cobot,
                                         bool wrist_sensor, Holding holding);

}  // namespace predictor
