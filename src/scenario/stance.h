// Determines where the operator stands, for the page, the headset and the evaluation of the person.
#pragma once

#include <array>

#include "core/hands.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Height of the eyes as a share of body height (Drillis & Contini 1966, quoted from memory).
inline constexpr double kEyeHeight = 0.936;

// The place of the operator's head at the start, in W.
struct Viewpoint {
  Vector3 eye;      // [m]
  double facing;    // direction of view, about z from the x axis [rad]
  bool is_a_guess;  // the scenario does not say where the operator stands, or how tall a body is
};

// Returns the viewpoint from the scenario's stance and body. Without stance and body, the function
// returns an assumption that is good enough for a camera. The operator is assumed to stand behind
// the object with the left handle on the left. If there is only one handle, the operator is assumed
// to face the cobot. `object_start` is O in W at the start, and `handles` are the places of the
// existing handles in O [m].
Viewpoint ViewpointOf(const Scenario& scenario, const Vector3& object_start,
                      const std::array<Vector3, kHands>& handles);

}  // namespace predictor
