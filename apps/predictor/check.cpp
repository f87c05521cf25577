#include "analysis/check.h"

#include <cstdio>
#include <fstream>

#include "commands.h"
#include "core/error.h"
#include "progress.h"

namespace predictor {

int CheckCommand(const ScenarioOptions& options, bool search) {
  const Scenario scenario = options.Load();
  Progress progress("Checking", 1, options.quiet);
  CheckOptions how;
  how.search = search;
  how.progress = [&](double share, const char* what) { progress.Update(share, what); };
  const CheckReport report = Check(scenario, how);
  progress.Finish();
  const bool to_stdout = options.summary == "-";
  if (!options.quiet) std::fputs(CheckText(report).c_str(), to_stdout ? stderr : stdout);
  if (to_stdout) {
    WriteOut(CheckJson(report));
  } else if (!options.summary.empty()) {
    std::ofstream file(options.summary);
    file << CheckJson(report);
    if (!file.flush())
      throw InputError("The report could not be written to '" + options.summary +
                       "'. Give a path in a folder that exists and may be written.");
  }
  return report.fit() ? kFinished : kUnfit;
}

}  // namespace predictor
