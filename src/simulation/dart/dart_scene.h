// Describes the scene of a scenario for DART, from the project's own models.
#pragma once

#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/dart/protocol.h"

namespace predictor {

// The object is attached to the cobot. Throws InputError with the key if the scene needs something
// that this engine lacks: soft limits, or collisions of a mesh.
dart_engine::SceneData DartScene(const Scenario& scenario, const RobotModel& cobot,
                                 const ObjectModel& object, double step);

}  // namespace predictor
