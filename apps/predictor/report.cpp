#include "report.h"

#include <cstdio>
#include <fstream>

#include "core/error.h"

namespace predictor {

void PrintSetup(const Emulator& emulator, bool quiet) {
  if (quiet) return;
  const EmulatorSetup& setup = emulator.setup();
  std::fprintf(stderr, "Scenario  %s\nDevice    %s\n", emulator.scenario().name.c_str(),
               setup.device.c_str());
  if (emulator.scenario().mode == Mode::kDirect) return;
  std::fprintf(
      stderr,
      "Lead      %.1f ms of the arms' lag of %.1f ms; the hand may be %.1f times as stiff and "
      "heavy%s\n",
      1e3 * setup.lead.lead, 1e3 * setup.lead.lag, setup.lead.margin.gain,
      setup.lead.margin.gain < 2 ? " (below 2: too little margin, see `predictor check`)" : "");
}

int Report(const Emulator& emulator, RunEnd end, double wall, const ScenarioOptions& options,
           Summary* summary) {
  if (end == RunEnd::kNotStarted) {
    std::fprintf(
        stderr,
        "predictor: the run never started: the arms did not come to the virtual handles.\n");
    return kDeviceFailure;
  }
  summary->real_time_factor = wall > 0 ? summary->duration / wall : 0;
  if (summary->stop) {
    summary->stop->duration = emulator.stop().duration;
    summary->stop->distance = emulator.stop().distance;
  }
  const bool to_stdout = options.summary == "-";
  if (!options.quiet) std::fputs(SummaryTable(*summary).c_str(), to_stdout ? stderr : stdout);
  if (to_stdout) {
    WriteOut(SummaryJson(*summary));
  } else if (!options.summary.empty()) {
    std::ofstream file(options.summary);
    file << SummaryJson(*summary);
    if (!file.flush())
      throw InputError("The summary could not be written to '" + options.summary +
                       "'. Give a path in a folder that exists and may be written.");
  }
  return end == RunEnd::kStopped ? kSafetyStop : kFinished;
}

}  // namespace predictor
