// The displacements that a scenario's `perturbation` describes, and the forces that these
// displacements cause.
#pragma once

#include <array>

#include "scenario/scenario.h"

namespace predictor {

// Returns the largest force with which a hand of this impedance, including its reflex, resists a
// displacement along any axis [N]. The handle is assumed to follow the command, which is a motion
// of minimum jerk. In reality, the lag of the handle and the motion of the virtual object make the
// force smaller.
double PerturbationForce(const PerturbationSpec& perturbation, const HandSpec& hand);

// Returns two unit vectors that span the plane of the displacements. The vectors are parallel to
// axes of W if the plane is parallel to a coordinate plane of W.
std::array<Vector3, 2> PerturbationPlane(const PerturbationSpec& perturbation);

}  // namespace predictor
