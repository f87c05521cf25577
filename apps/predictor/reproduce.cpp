#include "analysis/reproduce/reproduce.h"

#include "commands.h"
#include "progress.h"
#include "scenario/paths.h"

namespace predictor {

int ReproduceCommand(const ReproduceCommandOptions& options) {
  options.CheckWritable();
  options.RefuseToReplace(options.folder + "/index.html");
  Progress progress("Reproducing", 1, options.quiet);
  ReproduceOptions how;
  how.scenarios = FindShipped(options.scenarios);
  how.folder = options.folder;
  how.set = options.set;
  how.only = options.only;
  how.program_version = PREDICTOR_VERSION;
  how.progress = [&](double share, const std::string& what) { progress.Update(share, what); };
  const Reproduction reproduction = Reproduce(how);
  progress.Finish();
  WriteReproduction(reproduction, how.folder);
  options.Write(ReproductionText(reproduction) + "Wrote " + (how.folder / "index.html").string() +
                    ". Open it in any browser.\n",
                ReproductionJson(reproduction));
  return kFinished;
}

}  // namespace predictor
