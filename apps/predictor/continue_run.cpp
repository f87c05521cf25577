#include <filesystem>
#include <string>

#include "analysis/continuation/continuation.h"
#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "progress.h"
#include "recorded_run.h"
#include "recording/reader.h"
#include "restored_scenario.h"
#include "screen.h"

namespace predictor {
namespace {

StoppedRun ReadStop(const ContinueCommandOptions& options, const Scenario& scenario,
                    RecordingReader* reader) {
  Progress progress("Reading", static_cast<double>(reader->count()), options.quiet);
  try {
    return FindStop(reader, scenario,
                    [&](std::uint64_t tick) { progress.Update(static_cast<double>(tick)); });
  } catch (const InputError& error) {
    throw InputError(options.recording, error.what());
  }
}

}  // namespace

int ContinueCommand(const ContinueCommandOptions& options) {
  const std::filesystem::path file = options.recording;
  const std::string stem = std::filesystem::path(file).replace_extension("").string();
  const std::string page = options.page.empty() ? stem + ".continued.html" : options.page;
  options.CheckWritable();
  options.RefuseToReplace(page);
  RecordingReader reader(options.recording);
  ShowProblem(reader.problem());
  const RestoredScenario restored(reader.header());  // the continuation reads the models, too
  const StoppedRun run = ReadStop(options, restored.Get(), &reader);
  const HandSpec& hand = run.scenario.operator_.hand;
  const ArmDistribution arm =
      options.arm.empty() ? ArmDistribution::Prior(hand) : ArmDistribution::Read(options.arm, hand);
  Progress progress("Continuing", 1, options.quiet);
  ContinueOptions how;
  how.draws = options.draws;
  how.horizon = options.horizon;
  how.seed = options.seed;
  how.reference = run.scenario.operator_.type == "virtual";
  how.progress = [&](double share) { progress.Update(share); };
  const Continuation result = Continue(run, arm, how);
  progress.Finish();
  const std::string name = file.filename().string();
  WriteWholeFile(page, ContinuationPage(result, name, PREDICTOR_VERSION));
  options.Write(ContinuationText(result) + "Wrote " + page + ". Open it in a browser.\n",
                ContinuationJson(result, name));
  return kFinished;
}

}  // namespace predictor
