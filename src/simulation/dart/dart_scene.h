// The scene of a scenario for DART, from the project's own models.
#pragma once

#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/dart/protocol.h"

namespace predictor {

// The object hangs on the cobot. Throws InputError that names the key for what this engine does not
// have: soft limits, and collisions of a mesh.
dart_engine::SceneData DartScene(const Scenario& scenario, const RobotModel& cobot,
                                 const ObjectModel& object, double step);

}  // namespace predictor
