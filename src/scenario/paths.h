// Defines the places from which model files may be read: the scenario's folder, the assets beside
// it, and the configured package roots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

// The roots of package:// URIs are the folders in PREDICTOR_PACKAGE_PATH (separated by colons), if
// it is set, and then the robot descriptions that the build pinned. Both
// "package://example-robot-data/robots/..." and "package://panda_description/..." refer to these
// descriptions.
std::vector<std::filesystem::path> PackageRoots();

// Returns the folder of the robot descriptions that come with the program, with symlinks resolved.
// These are the descriptions in the data folder or, if it has none, those that the build pinned.
// These descriptions are identical on all computers with the same version of the program. Returns
// "" if there are no such descriptions.
std::filesystem::path PinnedRobots();

// Returns the folder with the scenarios, assets and robot descriptions of an installed program
// (share/predictor beside its bin), or the folder given to UseDataFolder. Returns "" for a program
// in a build folder.
std::filesystem::path DataFolder();

// Sets the location of the installed data, for programs that embed the emulator. This function is
// not thread-safe; call it before loading a scenario.
void UseDataFolder(const std::filesystem::path& folder);

// Resolves the symlinks in the part of `path` that exists, and returns the result.
std::filesystem::path Canonical(const std::filesystem::path& path);
// Returns whether `path` is `root` or is below `root`. Both must be canonical.
bool IsInside(const std::filesystem::path& path, const std::filesystem::path& root);

// Returns `path` if it exists. Otherwise returns the file with this path in the data folder
// ("scenarios/box_9kg.yaml") or the shipped scenario with this name ("box_9kg"). Otherwise returns
// `path`, for use in an error message.
std::filesystem::path FindShipped(const std::filesystem::path& path);

// Returns the readable folders for a scenario in this folder; see ResolveModelPath.
std::vector<std::filesystem::path> ModelFolders(const std::filesystem::path& scenario_folder);

// Returns the file for `uri` (package://..., file-relative, or relative to `base_folder`), with
// symlinks resolved. Apart from the package roots, only files in `scenario_folder` or in the folder
// "assets" beside it (a real folder, not a symlink) may be read. If `scenario_folder` is empty,
// `base_folder` is used instead. Throws InputError if the file does not exist, is not a regular
// file, is larger than 64 MiB, or is outside these places. The message names `uri`, the searched
// places and the remedy.
std::filesystem::path ResolveModelPath(const std::string& uri,
                                       const std::filesystem::path& base_folder,
                                       const std::filesystem::path& scenario_folder = {});

}  // namespace predictor
