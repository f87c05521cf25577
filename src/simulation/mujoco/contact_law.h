// The force of a point of contact between a body and a fixture in MuJoCo. DART has rigid contacts.
#pragma once

#include "scenario/fixture_spec.h"

namespace predictor {

// Spring, damper and inertia that act on a body while it touches a fixture at one point. The engine
// MuJoCo gives every contact an inertia; that of a fixture with a stiffness is negligible.
struct ContactLaw {
  double stiffness = 0;  // [N/m]
  double damping = 0;    // [N·s/m]
  double inertia = 0;    // [kg]
};

// Returns the law for a contact that moves `mass` [kg].
ContactLaw ContactLawOf(const FixtureSpec& fixture, double mass);

}  // namespace predictor
