#include <nlohmann/json.hpp>
#include <string>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "progress.h"
#include "recording/reader.h"
#include "scenario/own_parameters.h"
#include "scenario/paths.h"
#include "scenario/trial_note.h"
#include "screen.h"
#include "simulation/controller_trial.h"

namespace predictor {
namespace {

struct TriedLibrary {
  std::filesystem::path file;
  std::string parameters;
};

TriedLibrary LibraryOf(const Scenario& scenario) {
  const ParameterKind* kind = FindKind(Controllers(), scenario.cobot.controller.type);
  const YamlNode* library = scenario.cobot.controller.parameters.Find("library");
  const YamlNode* parameters = scenario.cobot.controller.parameters.Find("parameters");
  if (kind == nullptr || kind->place != ControllerPlace::kLibrary || library == nullptr)
    throw InputError("cobot.controller.type is " + Quote(scenario.cobot.controller.type) +
                     ", which needs no trial. Give a scenario with cobot.controller.type: plugin.");
  return {ResolveModelPath(library->text, scenario.folder()), parameters ? parameters->text : ""};
}

JointVector Joints(const std::array<double, kMaxCobotJoints>& values, int dof) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), dof);
}

TrialFigures TryOn(RecordingReader* reader, const Scenario& scenario, bool quiet) {
  ControllerTrial trial(scenario);
  const int dof = trial.dof();
  Progress progress("Trying", static_cast<double>(reader->count()), quiet);
  TickRecord record;
  for (std::uint64_t ticks = 1; reader->Next(&record); ++ticks) {
    if (record.cobot_dof != dof)
      throw InputError("The recording is of a cobot with " + std::to_string(record.cobot_dof) +
                       " joints, but the scenario's has " + std::to_string(dof) +
                       ". Give a recording of the same cobot.");
    if (record.ran != 0)
      trial.Step(record.run_time, Joints(record.cobot_q, dof), Joints(record.cobot_v, dof));
    if (ticks % 1000 == 0) progress.Update(static_cast<double>(ticks));
  }
  progress.Finish();
  if (trial.Figures().steps == 0)
    throw InputError("No simulated time passes in this recording. Give a recording of a run.");
  return trial.Figures();
}

std::string TextOf(const TrialFigures& f) {
  std::string text;
  AppendLine(&text, "%llu steps: %.1f µs (median), %.1f µs (99 %%), %.1f µs of CPU time (longest).",
             static_cast<unsigned long long>(f.steps), 1e6 * f.median, 1e6 * f.p99,
             1e6 * f.longest_cpu);
  if (f.allocating > 0)
    AppendLine(
        &text,
        "Unfit: the library allocates heap memory in %llu steps, first at %.3f s. Allocate all "
        "memory in create.",
        static_cast<unsigned long long>(f.allocating), f.first_allocation);
  if (f.not_finite > 0)
    AppendLine(&text, "Unfit: in %llu steps, the torques of the library are not finite.",
               static_cast<unsigned long long>(f.not_finite));
  if (f.p99 > f.kMaxTime || f.longest_cpu > f.kMaxCpuTime)
    AppendLine(
        &text,
        "Unfit: the library takes too long. The limits are %.0f µs in 99 %% of the steps, and %.0f "
        "µs of CPU time.",
        1e6 * f.kMaxTime, 1e6 * f.kMaxCpuTime);
  return text;
}

std::string JsonOf(const TrialFigures& f) {
  const nlohmann::json result = {{"passed", f.passed()},
                                 {"steps", f.steps},
                                 {"allocating_steps", f.allocating},
                                 {"not_finite_steps", f.not_finite},
                                 {"median_s", f.median},
                                 {"p99_s", f.p99},
                                 {"longest_cpu_s", f.longest_cpu}};
  return result.dump(2) + "\n";
}

}  // namespace

int TrialCommand(const ScenarioOptions& options, const std::string& recording) {
  const Scenario scenario = options.Load();
  const TriedLibrary library = LibraryOf(scenario);
  NoteTrial(library.file, library.parameters, false);  // also for one that crashes in the trial
  RecordingReader reader(recording);
  const TrialFigures figures = TryOn(&reader, scenario, options.quiet);
  std::string text = TextOf(figures);
  if (figures.passed()) {
    NoteTrial(library.file, library.parameters, true);
    AppendLine(
        &text,
        "Passed. The result is stored in %s. With these parameters, the library may now be used "
        "with real arms.",
        TrialNoteFile(library.file).string().c_str());
  }
  options.Write(text, JsonOf(figures));
  return figures.passed() ? kFinished : kUnfit;
}

}  // namespace predictor
