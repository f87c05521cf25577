// The shapes that represent a fixture in formats without capsules and planes.
#pragma once

#include <vector>

#include "models/urdf.h"
#include "scenario/fixture_spec.h"

namespace predictor {

// The thickness of the box that represents a plane. The upper face of the box is the plane [m].
inline constexpr double kPlaneDepth = 0.05;
inline constexpr double kKeepOutOpacity = 0.3;  // of a keep-out volume

// Returns boxes, cylinders and balls in W that represent the fixture. A capsule becomes a cylinder
// and two balls, and a plane becomes a thin box. A keep-out volume is transparent.
std::vector<ModelShape> FixtureShapes(const FixtureSpec& fixture);

}  // namespace predictor
