// Where the controlled scene stands still without hands.
#pragma once

#include "simulation/controlled_scene.h"

namespace predictor {

// Moves `data` from the cobot's posture, with the attachment at its zero, to a stable static
// equilibrium of gravity, controller at time 0 and contacts; joint friction is left out, since with
// it many postures would do. At the end velocities are zero and all |accelerations| < 1e-8 rad/s²
// (m/s²). Throws InputError if there is none. Allocates.
void FindEquilibrium(ControlledScene* scene, mjData* data);

}  // namespace predictor
