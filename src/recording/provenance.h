// What a run was made from, so that it can be looked at and made again elsewhere.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "recording/header.h"
#include "scenario/scenario.h"

namespace predictor {

// The header of a recording that begins now: the scenario with all its values, its model files
// (those that no pinned package holds, and every URDF) and the hashes of all of them. File names in
// COLLADA files (textures) are not followed. Throws InputError if a model cannot be read.
RecordingHeader DescribeRun(const Scenario& scenario, const std::string& program_version,
                            const std::map<std::string, std::string>& labels);

// The recorded scenario as text tells it; `file` is the recording's name for errors, and `folder`
// where relative model paths start. Throws InputError, also if damage took it.
Scenario RecordedScenario(const RecordingHeader& header, const std::string& file,
                          const std::filesystem::path& folder);

// Puts the recorded scenario and its model files under `folder` (which exists) and loads it from
// there. Adds to the folders in which packages are looked for, so not while other threads run.
// Throws InputError, also if a pinned robot description of this program is not the recorded one.
Scenario RestoreScenario(const RecordingHeader& header, const std::filesystem::path& folder);

}  // namespace predictor
