// Where model files may be read from: the scenario's folder tree and the configured package roots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

// Roots of package:// URIs: PREDICTOR_PACKAGE_PATH (colon-separated) if set, then the robot
// descriptions that the build pinned ("package://example-robot-data/robots/..." and
// "package://panda_description/..." both lead there).
std::vector<std::filesystem::path> PackageRoots();

// The file that `uri` (package://..., file-relative, or relative to `base_folder`) names, with
// symlinks resolved. Relative paths may leave `base_folder` only as far as `allowed_root` (the
// project or scenario collection: the nearest ancestor of base_folder that holds assets/, else
// base_folder itself). Throws InputError that names `uri`, what was searched and what to change,
// if the file does not exist, is not a regular file, is larger than 64 MiB, or lies outside.
std::filesystem::path ResolveModelPath(const std::string& uri,
                                       const std::filesystem::path& base_folder);

}  // namespace predictor
