// Where model files may be read from: the scenario's folder, the assets beside it and the
// configured package roots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

// Roots of package:// URIs: PREDICTOR_PACKAGE_PATH (colon-separated) if set, then the robot
// descriptions that the build pinned ("package://example-robot-data/robots/..." and
// "package://panda_description/..." both lead there).
std::vector<std::filesystem::path> PackageRoots();

// The folder of the robot descriptions that the build pinned, symlinks resolved: every machine with
// the same version has the same. Empty if there is none.
std::filesystem::path PinnedRobots();

// The file that `uri` (package://..., file-relative, or relative to `base_folder`) names, with
// symlinks resolved. Besides the package roots, only what lies in `scenario_folder` or in the
// folder "assets" beside it (a real folder, not a symlink) may be read; an empty `scenario_folder`
// stands for `base_folder`. Throws InputError that names `uri`, what was searched and what to
// change, if the file does not exist, is not a regular file, is larger than 64 MiB, or lies
// outside.
std::filesystem::path ResolveModelPath(const std::string& uri,
                                       const std::filesystem::path& base_folder,
                                       const std::filesystem::path& scenario_folder = {});

}  // namespace predictor
