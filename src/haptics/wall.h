// Models a wall that the object touches, as part of the linear model of the virtual world. Computes
// the impedance that the hands then feel.
#pragma once

#include <complex>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// A spring, a damper and an inertia that act on one point of the object, along one direction. The
// wall can push and pull, because the model describes small motions while the object stays in
// contact.
struct Wall {
  int hand = 0;                       // handle from which the point is measured
  Vector3 p_DC = Vector3::Zero();     // from the handle's origin to the point, axes of W [m]
  Vector3 normal = Vector3::UnitZ();  // unit vector in W
  double stiffness = 0, damping = 0;  // [N/m], [N·s/m]
  double inertia = 0;                 // [kg]; the engine's contacts also have an inertia
};

// Returns the model with the wall.
LinearModel WithWall(const LinearModel& world, const Wall& wall);

// Returns the effective mass at the wall's point along its normal [kg].
double MassAt(const LinearModel& world, const Wall& wall);

// The impedance that the hands feel if all of them press along `direction`. The impedance at one
// frequency is the total force of the hands divided by the mean displacement of their handles
// [N/m]. The real part is a stiffness. The imaginary part divided by 2π·frequency is a damping. If
// this damping is negative, the device feeds energy into the hands.
struct FeltImpedance {
  std::complex<double> requested;  // of the virtual world
  std::complex<double> rendered;   // by the arms, through the force sensors
};
// `dt` is the duration of a tick [s], and `lead` is the lead of the reference [s]. The delays are
// modelled exactly. `frequency` [Hz] must be positive, because at zero frequency a free world has
// no finite displacement.
FeltImpedance ImpedanceAt(const LinearModel& world, const Scenario& scenario, double lead,
                          double dt, const Vector3& direction, double frequency);

}  // namespace predictor
