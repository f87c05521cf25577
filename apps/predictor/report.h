// What `run` and `simulate` print and write, before and after.
#pragma once

#include "commands.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/summary.h"

namespace predictor {

// Device, lead and stability margin, on standard error.
void PrintSetup(const Emulator& emulator, bool quiet);

// Completes the summary with what the run measured, prints and writes it, and returns the exit
// code. wall: time from the first to the last tick [s].
int Report(const Emulator& emulator, RunEnd end, double wall, const ScenarioOptions& options,
           Summary* summary);

}  // namespace predictor
