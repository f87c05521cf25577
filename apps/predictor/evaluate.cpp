#include <filesystem>
#include <optional>
#include <string>

#include "assessment/comparison.h"
#include "assessment/output.h"
#include "commands.h"
#include "core/error.h"
#include "models/object_model.h"
#include "progress.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "scenario/scenario_io.h"
#include "screen.h"

namespace predictor {
namespace {

// Empty if the recorded models cannot be read; the reason is printed.
std::optional<double> ObjectMass(const RecordingHeader& header) {
  try {
    const TemporaryFolder folder;
    const Scenario scenario = RestoreScenario(header, folder.path());
    return LoadObject(scenario.object, scenario.folder()).mass;
  } catch (const InputError& error) {
    TheScreen().Tell(std::string("The object's mass is not known: ") + error.what());
    return {};
  }
}

assessment::Assessment Evaluate(const EvaluateOptions& options, const std::string& file) {
  RecordingReader reader(file);
  const RecordingHeader& header = reader.header();
  if (header.scenario_yaml.empty())
    throw InputError(file, "The recording has lost its scenario, so the person is not known.");
  const Scenario scenario = ParseScenario(header.scenario_yaml, file, ".", options.set);
  if (const auto missing = assessment::MissingForPosture(scenario); !missing.empty())
    throw InputError(file, missing.front() +
                               " For this recording, give it on the command line, for example "
                               "--set 'operator.body={height: 1.75, mass: 75, sex: male}' --set "
                               "'operator.stance={ground: [1, 0, -0.85], facing: 180 deg}'.");
  assessment::SampleCollector samples(scenario);
  ReadTicks(&reader, "Reading", options.quiet,
            [&](const TickRecord& record) { samples.Add(record); });
  if (!reader.problem().empty()) TheScreen().Tell(reader.problem());
  Progress progress("Evaluating", 1, options.quiet);
  assessment::AssessOptions how;
  how.intervals = options.intervals;
  how.work = {.repeated = options.repeated, .held = options.held};
  how.progress = [&](double share) { progress.Update(share); };
  assessment::Assessment result = Assess(scenario, ObjectMass(header), samples, how);
  progress.Finish();
  result.recording = std::filesystem::path(file).filename().string();
  return result;
}

}  // namespace

int EvaluateCommand(const EvaluateOptions& options) {
  const std::string stem = std::filesystem::path(options.recording).replace_extension("").string();
  const std::string page = options.page.empty() ? stem + ".person.html" : options.page;
  options.CheckWritable();
  options.RefuseToReplace(page);
  options.RefuseToReplace(options.csv);
  const assessment::Assessment result = Evaluate(options, options.recording);
  std::string text = AssessmentText(result);
  std::optional<assessment::Comparison> comparison;
  if (!options.against.empty()) {
    comparison = Compare(result, Evaluate(options, options.against));
    text += ComparisonText(*comparison);
  }
  WriteFile(page, AssessmentPage(result, PREDICTOR_VERSION));
  if (!options.csv.empty()) WriteFile(options.csv, AssessmentCsv(result));
  options.Write(text + "Wrote " + page + ". Open it in a browser.\n",
                AssessmentJson(result, comparison ? &*comparison : nullptr));
  return kFinished;
}

}  // namespace predictor
