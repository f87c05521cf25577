#include <filesystem>

#include "analysis/hazard_study/hazard_study.h"
#include "commands.h"
#include "progress.h"
#include "scenario/paths.h"

namespace predictor {

int HazardsCommand(const HazardsCommandOptions& options) {
  options.CheckWritable();
  Progress progress("Studying", 1, options.quiet);
  HazardStudyOptions how;
  for (const std::string& scenario : options.scenarios)
    how.scenarios.push_back(FindShipped(scenario));
  how.folder = options.folder;
  how.seeds = options.seeds;
  how.progress = [&](double share) { progress.Update(share, "hazards"); };
  const HazardStudy study = MakeHazardStudy(how);
  progress.Finish();
  options.Write(HazardStudyTables(study) + HazardStudyWords(study) + "Wrote " +
                    (how.folder / "hazards.csv").string() + " and the single runs, runs.csv.\n",
                HazardStudyJson(study));
  return kFinished;
}

}  // namespace predictor
