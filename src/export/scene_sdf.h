// Writes a scenario's virtual scene as SDF 1.9, for Gazebo.
#pragma once

#include <string>

#include "export/package_meshes.h"
#include "export/scene_tree.h"
#include "scenario/scenario.h"

namespace predictor::scene_export {

// The result is a world with steps of 1 ms. The world contains the model "predictor_scene", which
// is the cobot with the object, the models "floor", "table" and "fixture_…", which never move, and
// the models "movable_…". A link with mass becomes a
// <link> at the pose that it has with all joints at 0. A link without mass becomes a <frame>,
// unless a joint moves it. A spherical attachment is a ball joint. The limits come from the
// scenario's simulation.joint_limits and velocity_limits. Meshes are added to `meshes`. Throws the
// same InputError as PackageMeshes.
std::string SdfText(const SceneTree& tree, const Scenario& scenario, PackageMeshes* meshes);

}  // namespace predictor::scene_export
