#include "analysis/reproduce/reproduce.h"

#include "commands.h"
#include "progress.h"

namespace predictor {

int ReproduceCommand(const ReproduceCommandOptions& options) {
  Progress progress("Reproducing", 1, options.quiet);
  ReproduceOptions how;
  how.scenarios = options.scenarios;
  how.folder = options.folder;
  how.only = options.only;
  how.program_version = PREDICTOR_VERSION;
  how.progress = [&](double share, const std::string& what) { progress.Update(share, what); };
  const Reproduction reproduction = Reproduce(how);
  progress.Finish();
  WriteReproduction(reproduction, how.folder);
  if (!options.quiet)
    WriteOut(ReproductionText(reproduction) + "Wrote " + (how.folder / "index.html").string() +
             ". Open it in any browser.\n");
  return kFinished;
}

}  // namespace predictor
