// Stores the files from which a run was made, so that the run can be displayed and repeated
// elsewhere.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "recording/header.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns the header of a recording that starts now. The header contains the scenario with all its
// values, the model files of the scenario, and the hashes of all these files. The model files are
// every URDF, and all other files that no pinned package contains. File references in COLLADA files
// (textures) are not followed. Throws InputError if a model cannot be read.
RecordingHeader DescribeRun(const Scenario& scenario, const std::string& program_version,
                            const std::map<std::string, std::string>& labels);

// Adds the answers that a controller outside the program gave while the run was set up
// (EmulatorSetup::controller_tape). With these answers, the run can be repeated without the
// controller.
void AddControllerTape(const std::vector<double>& tape, RecordingHeader* header);

// Returns the recorded scenario from its text. `file` is the name of the recording, which error
// messages state. Relative model paths start at `folder`. Throws InputError, for example if the
// scenario is damaged.
Scenario RecordedScenario(const RecordingHeader& header, const std::string& file,
                          const std::filesystem::path& folder);

// Writes the recorded scenario and its model files into `folder` (which must exist) and loads the
// scenario from there. Extends the search path for packages, so no other threads may run. Throws
// InputError, for example if a pinned robot description of this program differs from the recorded
// one.
Scenario RestoreScenario(const RecordingHeader& header, const std::filesystem::path& folder);

}  // namespace predictor
