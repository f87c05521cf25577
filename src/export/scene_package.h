// A scenario's virtual scene as a package of one URDF and its meshes, for Unity's URDF-Importer and
// any other reader.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// A file of the package: text, or a copy of `source` where that is set.
struct PackageFile {
  std::string text = {};
  std::filesystem::path source = {};
};

struct ScenePackage {
  std::map<std::string, PackageFile> files;  // by path in the package, "/" between folders
  std::vector<std::string> notes;            // sentences on what was left out
};

inline constexpr const char* kSceneUrdf = "scene.urdf";  // path in the package

// The package: scene.urdf, meshes/…, package.xml and README.txt. The URDF lies beside the folder
// of meshes and names them by paths relative to itself, since that is the one way that
// URDF-Importer (which looks for package:// and ../ below the URDF's own folder), MuJoCo and plain
// readers all follow. The same scenario gives the same bytes. Throws InputError as loading the
// models does, and for meshes in a format that URDF-Importer does not read.
ScenePackage MakeScenePackage(const Scenario& scenario);

// Writes it into `folder`, which is made if need be. A folder that holds anything is refused unless
// `force`: then files that an earlier export wrote there are replaced or, where the package has
// them no more, removed; all others stay, and one that is in the way is refused. Throws InputError.
void WriteScenePackage(const ScenePackage& package, const std::filesystem::path& folder,
                       bool force);

}  // namespace predictor
