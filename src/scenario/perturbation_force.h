// The force that a displacement of the handles is expected to cause.
#pragma once

#include "scenario/scenario.h"

namespace predictor {

// Bound of the force with which a hand of this impedance resists one displacement [N]: the largest
// values of inertia, damping and stiffness, with the reflex, although they occur at different
// times. A minimum-jerk ramp over L in T has the peak speed 1.875 L/T and the peak acceleration
// 5.774 L/T² (Flash & Hogan 1985).
double PerturbationForce(const PerturbationSpec& perturbation, const HandSpec& hand);

}  // namespace predictor
