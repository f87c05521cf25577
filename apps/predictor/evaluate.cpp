#include "evaluate.h"

#include <filesystem>
#include <optional>
#include <string>

#include "assessment/comparison.h"
#include "assessment/output.h"
#include "core/error.h"
#include "core/text.h"
#include "models/object_model.h"
#include "models/urdf.h"
#include "progress.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"
#include "screen.h"

namespace predictor {
namespace {

// Longest run of which a report computes the intervals, which take half of real time to compute on
// a slow computer [s].
constexpr double kMaxIntervals = 120;

// Empty if the recorded models cannot be read; the reason is printed.
std::optional<assessment::SceneMasses> MassesOf(const RecordingHeader& header) {
  try {
    const TemporaryFolder folder;
    const Scenario scenario = RestoreScenario(header, folder.path());
    const CobotSpec& cobot = scenario.cobot;
    const UrdfModel urdf = ReadUrdf(ResolveModelPath(cobot.model, scenario.folder()),
                                    cobot.remove_links, scenario.folder());
    return assessment::SceneMasses{.cobot = urdf.MovingMass(),
                                   .object = LoadObject(scenario.object, scenario.folder()).mass};
  } catch (const InputError& error) {
    TheScreen().Tell(std::string("The masses of the virtual scene are not known: ") + error.what());
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
  assessment::SafetyCollector safety(scenario);
  ReadTicks(&reader, "Reading", options.quiet, [&](const TickRecord& record) {
    samples.Add(record);
    safety.Add(record);
  });
  if (!reader.problem().empty()) TheScreen().Tell(reader.problem());
  Progress progress("Evaluating", 1, options.quiet);
  assessment::AssessOptions how;
  how.intervals = options.intervals;
  how.work = {.repeated = options.repeated, .held = options.held};
  how.progress = [&](double share) { progress.Update(share); };
  const std::optional<assessment::SceneMasses> masses = MassesOf(header);
  assessment::Assessment result =
      Assess(scenario, masses ? std::optional(masses->object) : std::nullopt, samples, how);
  assessment::SafetyOptions judge{.intervals = options.intervals, .masses = masses};
  if (!options.contact_limits.empty())
    judge.limits = ergonomics::ReadContactLimits(options.contact_limits);
  result.safety = JudgeSafety(scenario, result.setup, safety, judge);
  progress.Finish();
  result.recording = std::filesystem::path(file).filename().string();
  return result;
}

}  // namespace

assessment::PersonOfRun PersonIn(const std::string& file, double duration,
                                 const ReportOptions& options) {
  const RecordingReader reader(file);
  const RecordingHeader& header = reader.header();
  assessment::PersonOfRun person;
  if (header.scenario_yaml.empty()) {
    person.why = "The recording has lost its scenario.";
    return person;
  }
  const Scenario scenario = ParseScenario(header.scenario_yaml, file, ".", options.set);
  if (const auto missing = assessment::MissingForPosture(scenario); !missing.empty()) {
    person.why = Join(missing, " ") +
                 " For this recording, give them to the report with --set, as "
                 "for predictor evaluate.";
    return person;
  }
  EvaluateOptions evaluate;
  evaluate.set = options.set;
  evaluate.quiet = options.quiet;
  const bool too_long = duration > kMaxIntervals;
  evaluate.intervals = !too_long;
  try {
    person.assessment = Evaluate(evaluate, file);
  } catch (const InputError& error) {
    person.why = error.what();
    return person;
  }
  if (too_long)
    person.assessment->warnings.push_back(
        "This is a long run, so there are no intervals and probabilities. To compute them, run: "
        "predictor evaluate " +
        file);
  return person;
}

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
