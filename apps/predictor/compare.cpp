#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "core/error.h"
#include "evaluation/fidelity.h"
#include "progress.h"
#include "recording/reader.h"

namespace predictor {
namespace {

struct Compared {
  std::string name;       // for people
  std::string condition;  // the recording's label, if it has one
  FidelitySignals signals;
};

Compared Read(const std::string& file, bool quiet) {
  RecordingReader reader(file);
  Compared run;
  run.name = std::filesystem::path(file).stem().string();
  const auto label = reader.header().labels.find("condition");
  if (label != reader.header().labels.end()) run.condition = label->second;
  FidelityCollector collector;
  Progress progress("Reading " + run.name, static_cast<double>(reader.count()), quiet);
  TickRecord record;
  for (std::uint64_t ticks = 1; reader.Next(&record); ++ticks) {
    collector.Add(record);
    if (ticks % 256 == 0) progress.Update(static_cast<double>(ticks));
  }
  progress.Finish();
  TellProblem(reader.problem());
  run.signals = collector.signals();
  if (run.signals.filled > 0)
    std::fprintf(stderr,
                 "%s: %zu of its hundredths of a second hold no tick; they are interpolated.\n",
                 file.c_str(), run.signals.filled);
  return run;
}

// The first to be compared, the others as its repeats.
std::vector<FidelitySignals> ReadAll(const std::vector<std::string>& files, bool quiet,
                                     Compared* first) {
  std::vector<FidelitySignals> signals;
  for (const std::string& file : files) {
    Compared run = Read(file, quiet);
    signals.push_back(std::move(run.signals));
    if (&file == &files.front()) *first = {run.name, run.condition, {}};
  }
  return signals;
}

}  // namespace

int CompareCommand(const CompareOptions& options) {
  Compared a, b;
  const std::vector<FidelitySignals> of_a = ReadAll(options.a, options.quiet, &a);
  const std::vector<FidelitySignals> of_b = ReadAll(options.b, options.quiet, &b);
  if (!a.condition.empty() && !b.condition.empty() && a.condition != b.condition) {
    a.name = a.condition;
    b.name = b.condition;
  }
  std::optional<bool> by_phase;
  if (options.by_phase) by_phase = true;
  if (options.by_time) by_phase = false;
  const FidelityReport report = CompareFidelity(of_a, of_b, by_phase);
  ScenarioOptions to;
  to.summary = options.summary;
  to.quiet = options.quiet;
  to.Write(FidelityText(report, a.name, b.name), FidelityJson(report, a.name, b.name));
  return kFinished;
}

}  // namespace predictor
