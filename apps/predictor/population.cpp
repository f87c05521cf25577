#include "analysis/population/population.h"

#include <filesystem>

#include "commands.h"
#include "progress.h"
#include "scenario/paths.h"

namespace predictor {

int PopulationCommand(const PopulationCommandOptions& options) {
  options.CheckWritable();
  Progress progress("Studying", 1, options.quiet);
  population::PopulationOptions how;
  for (const std::string& scenario : options.scenarios)
    how.scenarios.push_back(FindShipped(scenario));
  how.set = options.set;
  how.heights = options.heights;
  how.folder = options.folder;
  how.persons = options.persons;
  how.seed = options.seed;
  how.workers = options.workers;
  how.program_version = PREDICTOR_VERSION;
  how.progress = [&](double share) { progress.Update(share, "people"); };
  const population::PopulationStudy study = MakePopulationStudy(how);
  progress.Finish();
  options.Write(PopulationText(study) + "Wrote " + (how.folder / "population.html").string() +
                    " and three CSV files. Open the page in a browser.\n",
                PopulationJson(study));
  return kFinished;
}

}  // namespace predictor
