// Exports a scenario's virtual scene as a package. The package contains a URDF and its meshes, for
// Unity's URDF-Importer and other readers, or an SDF file and its meshes, for Gazebo.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor::scene_export {

// A file of the package. It is a copy of `source` or, if `source` is empty, it contains `text`.
struct PackageFile {
  std::string text = {};
  std::filesystem::path source = {};
};

struct ScenePackage {
  std::map<std::string, PackageFile> files;  // by path in the package, with "/" between folders
  std::vector<std::string> notes;            // sentences about omitted files
};

inline constexpr const char* kSceneUrdf = "scene.urdf";  // path in the package
inline constexpr const char* kSceneSdf = "scene.sdf";

enum class SceneFormat {
  kUrdf,  // URDF for Unity's URDF-Importer and other readers
  kSdf,   // SDF for Gazebo
};

// Returns the files of the package: scene.urdf, meshes/…, package.xml and README.txt. The URDF is
// next to the folder of meshes, and refers to the meshes by relative paths. Only relative paths
// work in URDF-Importer (which looks for package:// and ../ below the URDF's own folder), in MuJoCo
// and in plain readers. Exports of the same scenario always contain the same bytes. Throws
// InputError if a model cannot be loaded or if URDF-Importer does not support a mesh format. For
// kSdf, the files are scene.sdf, meshes/… and README.txt.
ScenePackage MakeScenePackage(const Scenario& scenario, SceneFormat format = SceneFormat::kUrdf);

// Writes the package into `folder`, which is created if necessary. A folder that is not empty is
// refused unless `force` is set. With `force`, files of an earlier export are replaced, or removed
// if the package no longer contains them. Other files stay. If one of the files in the folder is
// not from an earlier export and would be overwritten, the export is refused. Throws InputError.
void WriteScenePackage(const ScenePackage& package, const std::filesystem::path& folder,
                       bool force);

}  // namespace predictor::scene_export
