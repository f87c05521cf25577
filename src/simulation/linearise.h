// Linear model of the controlled scene, for stability margins and for tests.
#pragma once

#include <array>

#include "simulation/controlled_scene.h"

namespace predictor {

// About the posture of `data`, at rest, with the set-point of time t [s]. State: changes of the
// coordinates (nv, tangent space) and their rates (nv). Inputs and outputs as LinearModel says,
// for the handles D at X_OD; sides that are not `present` are zero. Coulomb friction is left out.
// Leaves `data` and `scene` at another state. Allocates.
LinearModel Linearise(ControlledScene* scene, mjData* data, double t,
                      const std::array<bool, kHands>& present,
                      const std::array<Pose, kHands>& X_OD);

}  // namespace predictor
