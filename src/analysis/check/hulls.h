// Finds meshes whose convex hull is much larger than the mesh. The physics engine lets the hull
// collide, so it fills holes and recesses of such a mesh.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// Returns a sentence with a remedy for each mesh that can collide and whose hull is more than 1.3
// times as large as the mesh. The meshes are those of the carried object and of the moving links of
// the cobot, if a fixture or a movable object touches them, and those of the movable objects.
// Throws InputError if a model cannot be read.
std::vector<std::string> HullWarnings(const Scenario& scenario);

}  // namespace predictor
