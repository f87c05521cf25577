#include "analysis/check.h"

#include "commands.h"
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
  options.Write(CheckText(report), CheckJson(report));
  return report.fit() ? kFinished : kUnfit;
}

}  // namespace predictor
