// The output that `run` and `simulate` print before and after the run.
#pragma once

#include <optional>

#include "commands.h"
#include "core/predicted_loop.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/summary.h"

namespace predictor {

// Prints the device, the lead and the stability margin to standard error.
void PrintSetup(const Emulator& emulator, bool quiet);

// Returns the prediction for the haptic loop, or no value if the run has no arms.
std::optional<PredictedLoop> PredictedLoopOf(const Emulator& emulator);

// Adds the measurements of the run to the summary, prints and writes the summary, and returns the
// exit code. `wall` is the time from the first to the last tick [s].
int Report(const Emulator& emulator, RunEnd end, double wall, const ScenarioOptions& options,
           Summary* summary);

}  // namespace predictor
