#include "evaluate.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "assessment/comparison.h"
#include "assessment/output.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "core/text.h"
#include "evaluated_run.h"
#include "muscles/myo_arm.h"
#include "progress.h"
#include "recording/reader.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

// Duration of the longest run for which a report computes the intervals [s]. On a slow computer,
// this computation takes half as long as the run.
constexpr double kMaxIntervals = 120;

void AddSafety(const EvaluatedRun& run, const EvaluateOptions& options,
               assessment::Assessment* result) {
  if (!run.safety) {
    result->not_evaluable.push_back(
        {"the safety of the collaboration",
         "a recording of another system contains no stops, limits or energies"});
    return;
  }
  assessment::SafetyOptions judge{.intervals = options.intervals, .masses = run.masses};
  if (!options.contact_limits.empty())
    judge.limits = ergonomics::ReadContactLimits(options.contact_limits);
  result->safety = JudgeSafety(run.scenario, result->setup, *run.safety, judge);
}

// `trial` contains a share of strength and a time [s], or nothing.
std::optional<ergonomics::TrialFatigue> TrialOf(const std::vector<double>& trial) {
  if (trial.empty()) return {};
  ergonomics::TrialFatigue result;
  const double load = trial[0], time = trial[1];
  if (!(load >= result.threshold && load <= 1))
    throw InputError(Formatted("--fatigue-trial: The share of strength must be %g to 1, not %g.",
                               result.threshold, load));
  if (!(time > 0 && std::isfinite(time)))
    throw InputError(Formatted("--fatigue-trial: The time must be above 0 s, not %g s.", time));
  result.reference_load = load;
  result.reference_time = time;
  return result;
}

assessment::WorkPattern WorkOf(const EvaluateOptions& options) {
  using ergonomics::Coupling, ergonomics::LiftDuration;
  assessment::WorkPattern work{.repeated = options.repeated, .held = options.held};
  work.coupling = options.coupling == "good"   ? Coupling::kGood
                  : options.coupling == "fair" ? Coupling::kFair
                                               : Coupling::kPoor;
  work.lifting = options.lifting == "1h"   ? LiftDuration::kShort
                 : options.lifting == "2h" ? LiftDuration::kModerate
                                           : LiftDuration::kLong;
  work.grip_effort = options.grip_effort;
  work.fatigue_trial = TrialOf(options.fatigue_trial);
  return work;
}

// Returns what a comparison states about the design. Another system does not record its design.
assessment::ComparedDesign DesignOf(const EvaluatedRun& run, const assessment::Assessment& result) {
  assessment::ComparedDesign design;
  if (run.safety) design.scenario = run.scenario;
  design.object_mass = run.object_mass;
  const Pose X_SW = result.setup.stance.X_WS.Inverse();
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!result.hands[i]) continue;
    sum += (X_SW * run.run.handles[i].p).z();
    count += 1;
  }
  design.handle_height = sum / count;
  return design;
}

assessment::Assessment Evaluate(const EvaluateOptions& options, const std::string& file,
                                const std::vector<std::string>& tracks,
                                assessment::ComparedDesign* design = nullptr) {
  std::vector<assessment::UserLimits> limits;
  for (const std::string& limit : options.limits)
    limits.push_back(assessment::ReadUserLimits(limit));
  const EvaluatedRun run = OpenRun(file, options, tracks);
  Progress progress("Evaluating", 1, options.quiet);
  assessment::AssessOptions how = run.Options();
  how.intervals = options.intervals;
  if (!options.arm_model.empty()) how.arm = muscles::LoadMyoArm(options.arm_model);
  how.work = WorkOf(options);
  how.progress = [&](double share) { progress.Update(share); };
  assessment::Assessment result = Assess(run.scenario, run.object_mass, run.run, how);
  for (const assessment::UserLimits& limit : limits) JudgeUserLimits(limit, &result);
  AddSafety(run, options, &result);
  progress.Finish();
  result.recording = run.file;
  result.participant = run.participant;
  if (design) *design = DesignOf(run, result);
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
                 " For this recording, pass the missing values to the report with --set, as for "
                 "predictor evaluate.";
    return person;
  }
  EvaluateOptions evaluate;
  evaluate.set = options.set;
  evaluate.quiet = options.quiet;
  const bool too_long = duration > kMaxIntervals;
  evaluate.intervals = !too_long;
  try {
    person.assessment = Evaluate(evaluate, file, {});
  } catch (const InputError& error) {
    person.why = error.what();
    return person;
  }
  if (too_long)
    person.assessment->warnings.push_back(
        "The run is long, so the report contains no intervals and probabilities. To compute them, "
        "run: predictor evaluate " +
        file);
  return person;
}

namespace {

std::string WithoutEnding(const std::string& recording) {
  return std::filesystem::path(recording).replace_extension("").string();
}

std::string StemOf(const std::string& recording) {
  return std::filesystem::path(WithoutEnding(recording)).filename().string();
}

// The files for the results of one recording. "": no file.
struct ResultFiles {
  std::string page, csv, json;
};

assessment::RecordedLifts EvaluateOne(const EvaluateOptions& options, const std::string& recording,
                                      const ResultFiles& files) {
  OutputOptions output = options;
  output.json = files.json;
  output.CheckWritable();
  output.RefuseToReplace(files.page);
  output.RefuseToReplace(files.csv);
  assessment::ComparedDesign of_this, of_other;
  const assessment::Assessment result = Evaluate(options, recording, options.tracks, &of_this);
  std::string text = AssessmentText(result);
  std::optional<assessment::Comparison> comparison;
  if (!options.against.empty()) {
    comparison =
        Compare(result, Evaluate(options, options.against, options.against_tracks, &of_other));
    AddDesigns(of_this, of_other, &*comparison);
    text += ComparisonText(*comparison);
  }
  WriteWholeFile(files.page,
                 AssessmentPage(result, PREDICTOR_VERSION, comparison ? &*comparison : nullptr));
  if (!files.csv.empty()) WriteWholeFile(files.csv, AssessmentCsv(result));
  output.Write(text + "Wrote " + files.page + ". Open it in a browser.\n",
               AssessmentJson(result, comparison ? &*comparison : nullptr));
  return {result.recording, result.participant ? result.participant->pseudonym : "",
          result.duration / 60, result.lifts};
}

// Throws InputError if an option belongs to one recording, or if results would get the same name.
void RefuseForSeveral(const EvaluateOptions& options) {
  if (!options.tracks.empty())
    throw InputError(
        "--track: A track belongs to one recording. Evaluate the recordings one by one.");
  if (options.json == "-")
    throw InputError("--json: With several recordings, give the name of a folder.");
  std::set<std::string> stems;
  for (const std::string& recording : options.recordings)
    if (!stems.insert(StemOf(recording)).second)
      throw InputError(recording,
                       "Another recording has the same name, so their results would have the same "
                       "name, too. Rename one of the recordings.");
}

// Returns the file NAME in a folder, which is created, or "" without a folder.
std::string FileIn(const std::string& folder, const std::string& name) {
  if (folder.empty()) return "";
  std::filesystem::create_directories(folder);
  return std::filesystem::path(folder) / name;
}

// Returns the files for one of several recordings. The outputs of the options are folders.
ResultFiles FilesFor(const std::string& recording, const EvaluateOptions& options) {
  const std::string stem = StemOf(recording) + ".person";
  const std::string beside = WithoutEnding(recording) + ".person.html";
  return {options.page.empty() ? beside : FileIn(options.page, stem + ".html"),
          FileIn(options.csv, stem + ".csv"), FileIn(options.json, stem + ".json")};
}

int EvaluateSeveral(const EvaluateOptions& options) {
  RefuseForSeveral(options);
  OutputOptions output = options;
  output.json = FileIn(options.json, "lifting_job.json");
  const std::string csv = FileIn(options.csv, "lifting_job.csv");
  output.CheckWritable();
  output.RefuseToReplace(csv);
  std::vector<assessment::RecordedLifts> lifts;
  for (const std::string& recording : options.recordings)
    lifts.push_back(EvaluateOne(options, recording, FilesFor(recording, options)));
  if (!csv.empty()) WriteWholeFile(csv, assessment::LiftingJobCsv(lifts));
  const assessment::LiftingJob job = assessment::JobOf(lifts);
  if (job.lifts > 1)
    output.Print("\nIf one person does the work of all recordings: " + Sentence(job) + "\n");
  output.WriteJson(assessment::LiftingJobJson(lifts));
  return kFinished;
}

}  // namespace

int EvaluateCommand(const EvaluateOptions& options) {
  if (options.recordings.size() > 1) return EvaluateSeveral(options);
  const std::string& recording = options.recordings.front();
  EvaluateOne(options, recording,
              {options.page.empty() ? WithoutEnding(recording) + ".person.html" : options.page,
               options.csv, options.json});
  return kFinished;
}

}  // namespace predictor
