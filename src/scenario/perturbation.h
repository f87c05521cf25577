// The displacements that a scenario's `perturbation` describes, and the force that they cause.
#pragma once

#include <array>

#include "scenario/scenario.h"

namespace predictor {

// Largest force with which a hand of this impedance, with its reflex, resists a displacement along
// any axis [N]. The handle follows the command, a motion of minimum jerk; in truth, its lag and the
// motion of the virtual object make the force smaller.
double PerturbationForce(const PerturbationSpec& perturbation, const HandSpec& hand);

// Two unit vectors that span the plane of the displacements; along axes of W if the plane is.
std::array<Vector3, 2> PerturbationPlane(const PerturbationSpec& perturbation);

}  // namespace predictor
