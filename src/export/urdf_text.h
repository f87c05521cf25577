// Writes the scene as URDF.
#pragma once

#include <string>

#include "export/package_meshes.h"
#include "export/scene_tree.h"

namespace predictor::scene_export {

// Returns the URDF. Gravity [m/s²] is in MuJoCo's element, which other readers ignore. The text
// contains what URDF-Importer requires beyond the format's rules: an axis on every moving joint,
// effort and velocity in every limit, a name for every material, and the same name only for the
// same colour. Meshes and textures are added to `meshes`. Throws InputError as PackageMeshes does.
std::string UrdfText(const SceneTree& tree, double gravity, PackageMeshes* meshes);

}  // namespace predictor::scene_export
