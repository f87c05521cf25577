// Computes a linear model of the controlled scene, for stability margins and for tests.
#pragma once

#include <array>

#include "simulation/controlled_scene.h"

namespace predictor {

// Linearises about the posture of `engine`, which is in a state of the present scene, at rest, with
// the set-point of time t [s]. The state contains changes of the coordinates (nv, tangent space)
// and their rates (nv), and then the states of the wrist sensor and the controller. LinearModel
// defines inputs and outputs, for the handles D at X_OD. Sides that are not `present` are zero.
// Coulomb friction is ignored. Changes the state of `engine` and `scene`. Allocates memory.
LinearModel Linearise(ControlledScene* scene, Engine* engine, double t, const Hands& hands,
                      const std::array<Pose, kHands>& X_OD);

}  // namespace predictor
