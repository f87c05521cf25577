// A wall that the object touches, added to the linear model of the virtual world, and what a hand
// then feels through the arms.
#pragma once

#include <complex>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// A spring, a damper and an inertia that act on one point of the object, along one direction. They
// push and pull: the model describes small motions while the object stays in contact.
struct Wall {
  int hand = 0;                       // handle from which the point is measured
  Vector3 p_DC = Vector3::Zero();     // from the handle's origin to the point, axes of W [m]
  Vector3 normal = Vector3::UnitZ();  // unit vector in W
  double stiffness = 0, damping = 0;  // [N/m], [N·s/m]
  double inertia = 0;                 // [kg]; contacts of the engine have one
};

// Returns the model with the wall.
LinearModel WithWall(const LinearModel& world, const Wall& wall);

// Returns the mass that a force at the wall's point and along its normal moves [kg].
double MassAt(const LinearModel& world, const Wall& wall);

// What the hands feel if all of them together press along `direction`, and their handles' mean
// displacement answers: force over displacement [N/m] at a frequency [Hz]. Its real part is a
// stiffness. Its imaginary part divided by 2π·frequency is a damping; if that is negative, the
// device feeds energy into the hands.
struct FeltImpedance {
  std::complex<double> requested;  // of the virtual world
  std::complex<double> rendered;   // by the arms, through the force sensors
};
// `dt` is the duration of a tick [s], `lead` that of the reference [s]. The delays are exact.
// `frequency` must be positive, because a world may be free at rest.
FeltImpedance ImpedanceAt(const LinearModel& world, const Scenario& scenario, double lead,
                          double dt, const Vector3& direction, double frequency);

}  // namespace predictor
