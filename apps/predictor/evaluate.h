// Evaluates the person in a recording, for other commands.
#pragma once

#include <string>

#include "assessment/output.h"
#include "commands.h"

namespace predictor {

// Judges the person of a recording. The result contains 90 % intervals unless the run is too long
// for a report. If the person cannot be judged, the result contains the reason. Throws InputError
// if the recording cannot be read or an override is invalid.
assessment::PersonOfRun PersonIn(const std::string& file, double duration,
                                 const ReportOptions& options);

}  // namespace predictor
