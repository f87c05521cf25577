// The shapes that represent a fixture in formats without capsules and planes.
#pragma once

#include <vector>

#include "models/urdf.h"
#include "scenario/fixture_spec.h"

namespace predictor {

// Thickness of the box that represents a plane; its upper face is the plane [m].
inline constexpr double kPlaneDepth = 0.05;

// The fixture as boxes, cylinders and balls, in W: a capsule as a cylinder and two balls, a plane
// as a thin box.
std::vector<ModelShape> FixtureShapes(const FixtureSpec& fixture);

}  // namespace predictor
