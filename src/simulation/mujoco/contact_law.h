// Describes the force at a point of contact between a body and a fixture in MuJoCo. DART has rigid
// contacts.
#pragma once

#include "scenario/fixture_spec.h"

namespace predictor {

// Spring, damper and inertia that act on a body while it touches a fixture at one point. MuJoCo
// gives every contact an inertia. For a fixture with a stiffness, this inertia is negligible.
struct ContactLaw {
  double stiffness = 0;  // [N/m]
  double damping = 0;    // [N·s/m]
  double inertia = 0;    // [kg]
};

// Returns the law for a contact that moves `mass` [kg].
ContactLaw ContactLawOf(const FixtureSpec& fixture, double mass);

}  // namespace predictor
