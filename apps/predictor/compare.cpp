#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "evaluation/fidelity.h"
#include "evaluation/stops.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "scenario/task.h"
#include "screen.h"

namespace predictor {
namespace {

struct Compared {
  std::string name;                  // name to display
  std::string condition;             // the recording's label, if it has one
  std::optional<Scenario> scenario;  // empty if it is damaged
  FidelitySignals signals;
  StopCause stopped = StopCause::kNone;  // cause of the first stop
};

Compared Read(const std::string& file, bool quiet) {
  RecordingReader reader(file);
  Compared run;
  run.name = std::filesystem::path(file).stem().string();
  const auto label = reader.header().labels.find("condition");
  if (label != reader.header().labels.end()) run.condition = label->second;
  if (!reader.header().scenario_yaml.empty())
    run.scenario = RecordedScenario(reader.header(), file, ".");
  FidelityCollector collector;
  ReadTicks(&reader, "Reading " + run.name, quiet, [&](const TickRecord& record) {
    collector.Add(record);
    if (run.stopped == StopCause::kNone) run.stopped = record.cause;
  });
  ShowProblem(reader.problem());
  run.signals = collector.signals();
  if (run.signals.filled > 0)
    TheScreen().Print(
        Formatted("%s: %zu of its samples (10 ms each) are missing and were interpolated.",
                  file.c_str(), run.signals.filled));
  return run;
}

// Reads the recordings of one side: the first recording is compared, and the others are repeats of
// it.
std::vector<Compared> ReadAll(const std::vector<std::string>& files, bool quiet) {
  std::vector<Compared> runs;
  for (const std::string& file : files) runs.push_back(Read(file, quiet));
  return runs;
}

std::vector<FidelitySignals> SignalsOf(std::vector<Compared>* runs) {
  std::vector<FidelitySignals> signals;
  for (Compared& run : *runs) signals.push_back(std::move(run.signals));
  return signals;
}

// A comparison is meaningful only for runs of the same task.
void WarnOfOtherTask(const Compared& first, const Compared& other, FidelityReport* report) {
  if (!first.scenario || !other.scenario) {
    report->warnings.push_back("It is unknown whether " + other.name + " had the same task as " +
                               first.name +
                               ", because a recording is damaged and its scenario is lost.");
    return;
  }
  const std::vector<std::string> different = TaskDifferences(*first.scenario, *other.scenario);
  if (different.empty()) return;
  report->warnings.push_back(
      other.name + " has a different task from " + first.name + ": " + Join(different) +
      (different.size() == 1 ? " differs" : " differ") +
      ". This difference between the runs may explain all other differences in the figures.");
}

// A stop by the emulator cuts off the forces that the person would have felt later.
void WarnOfStop(const Compared& run, FidelityReport* report) {
  if (!IsLimit(run.stopped)) return;
  report->warnings.push_back(
      Formatted("The emulator stopped %s at a limit (%s), so the largest values of this run are "
                "only lower bounds. `predictor continue` predicts what would have happened.",
                run.name.c_str(), Name(run.stopped)));
}

}  // namespace

int CompareCommand(const CompareOptions& options) {
  options.CheckWritable();
  std::vector<Compared> runs_a = ReadAll(options.a, options.quiet);
  std::vector<Compared> runs_b = ReadAll(options.b, options.quiet);
  const std::vector<FidelitySignals> of_a = SignalsOf(&runs_a), of_b = SignalsOf(&runs_b);
  Compared &a = runs_a.front(), &b = runs_b.front();
  if (!a.condition.empty() && !b.condition.empty() && a.condition != b.condition) {
    a.name = a.condition;
    b.name = b.condition;
  }
  std::optional<bool> by_phase;
  if (options.by_phase) by_phase = true;
  if (options.by_time) by_phase = false;
  FidelityReport report = CompareFidelity(of_a, of_b, by_phase);
  for (const auto* runs : {&runs_a, &runs_b})
    for (const Compared& run : *runs) WarnOfStop(run, &report);
  for (const auto* runs : {&runs_a, &runs_b})
    for (const Compared& run : *runs)
      if (&run != &runs_a.front()) WarnOfOtherTask(runs_a.front(), run, &report);
  options.Write(FidelityText(report, a.name, b.name), FidelityJson(report, a.name, b.name));
  return kFinished;
}

}  // namespace predictor
