// Where the operator stands, for the page, the headset, and the evaluation of the person.
#pragma once

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Height of the eyes, as a share of the body's height (Drillis & Contini 1966, recalled).
inline constexpr double kEyeHeight = 0.936;

// The place of the operator's head at the start, in W.
struct Viewpoint {
  Vector3 eye;      // [m]
  double facing;    // direction of view, about z from the x axis [rad]
  bool is_a_guess;  // the scenario does not say where the operator stands, or how tall a body is
};

// From the scenario's stance and body. Without them, a guess that is good enough for a camera: the
// operator stands behind the object with the left handle on the left, or, with one handle, faces
// the cobot. `object_start`: O in W at the start [m].
Viewpoint ViewpointOf(const Scenario& scenario, const Vector3& object_start);

}  // namespace predictor
