// Reads waypoints from a CSV file, for a controller that has the parameters `trajectory` and
// `trajectory_file`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "scenario/yaml_tree.h"

namespace predictor {

inline constexpr std::size_t kMaxWaypoints = 1000;

// Returns the list of waypoints in a text with the header time,x,y,z or time,x,y,z,roll,pitch,yaw.
// Each value keeps its place in the file `name`, so that messages about the value show this place.
// Throws InputError.
YamlNode ParseWaypoints(const std::string& text, const std::string& name);

// Replaces cobot.controller.trajectory_file in a scenario's tree with the waypoints in that file.
// ResolveModelPath finds the file, starting from `folder`. Saved scenarios and recordings then
// contain the waypoints, and do not need the file. Throws InputError.
void ExpandTrajectoryFile(const std::filesystem::path& folder, YamlNode* root);

}  // namespace predictor
