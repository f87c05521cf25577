// Describes the scene of a scenario for DART, from the project's own models.
#pragma once

#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/dart/protocol.h"
#include "simulation/engine.h"

namespace predictor {

// Throws InputError with the key if the scene needs a property that this engine lacks: soft limits,
// fixtures that yield or that touch the cobot, or collisions of a mesh.
dart_engine::SceneData DartScene(const Scenario& scenario, const RobotModel& cobot,
                                 const ObjectModel& object, double step,
                                 Holding holding = Holding::kJoint);

// A body without gravity hits a linear spring and damper of this damping ratio, which can push but
// not pull. Returns the ratio of the speeds with which the body leaves and meets the spring
// (Schwager and Pöschel, Granular Matter 9:465, 2007, eqs. 20 and 21).
double RestitutionOf(double damping_ratio);

}  // namespace predictor
