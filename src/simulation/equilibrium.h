// Finds the equilibrium of the controlled scene without hands.
#pragma once

#include "simulation/controlled_scene.h"

namespace predictor {

// Moves the carried object's engine from the cobot's posture, with the attachment at its zero, to a
// stable static equilibrium of gravity, contacts, and the controller at time 0. Joint friction is
// ignored, since it would make many postures equilibria. At the end, velocities are zero and all
// |accelerations| are below 1e-8 rad/s² (m/s²). `environment` is that of the scenario. Throws
// InputError if no equilibrium is found, or if bodies overlap by more than 1 mm in this posture.
// Allocates memory.
void FindEquilibrium(const EnvironmentSpec& environment, ControlledScene* scene);

}  // namespace predictor
