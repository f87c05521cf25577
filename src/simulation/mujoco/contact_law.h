// Describes the force at a point of contact between a body and its surroundings in MuJoCo. DART has
// rigid contacts.
#pragma once

#include "scenario/fixture_spec.h"

namespace predictor {

// Spring, damper and inertia that act on a body while it touches something at one point. MuJoCo
// gives every contact an inertia. For a fixture with a stiffness, this inertia is negligible.
struct ContactLaw {
  double stiffness = 0;  // [N/m]
  double damping = 0;    // [N·s/m]
  double inertia = 0;    // [kg]
};

// Returns the law for a contact that moves `mass` [kg].
ContactLaw ContactLawOf(const FixtureSpec& fixture, double mass);

// Return the laws for a contact of the carried object with the floor or the table that moves `mass`
// [kg]. The engine's contact becomes stiffer as it becomes deeper. The first law applies to small
// penetrations, and the second one to penetrations of 1 mm or more.
ContactLaw LightContactLaw(double mass);
ContactLaw DeepContactLaw(double mass);

}  // namespace predictor
