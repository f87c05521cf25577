// Finds meshes whose convex hull is much larger than the mesh. The physics engine lets the hull
// collide, so it fills holes and recesses of such a mesh.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"
#include "simulation/contact_pair.h"

namespace predictor {

// Returns a sentence with a remedy for each mesh that can collide and whose hull is more than 1.3
// times as large as the mesh. The meshes are those of the carried object and of the moving links of
// the cobot, if a fixture or a movable object touches them, those of the movable objects, and those
// of the bodies that can touch because of cobot.touches, which `pairs` contains. Throws InputError
// if a model cannot be read.
std::vector<std::string> HullWarnings(const Scenario& scenario,
                                      const std::vector<ContactPair>& pairs);

}  // namespace predictor
