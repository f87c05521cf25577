// The scene as URDF.
#pragma once

#include <string>

#include "export/package_meshes.h"
#include "export/scene_tree.h"

namespace predictor {

// Text of the URDF, gravity [m/s²] told in MuJoCo's element, which others pass over. It has what
// URDF-Importer needs beyond the format's rules: an axis on every joint that moves, effort and
// velocity in every limit, a name on every material, and the same name only for the same colour.
// Meshes and textures are added to `meshes`. Throws InputError as PackageMeshes does.
std::string UrdfText(const SceneTree& tree, double gravity, PackageMeshes* meshes);

}  // namespace predictor
