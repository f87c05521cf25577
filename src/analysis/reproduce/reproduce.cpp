#include "analysis/reproduce/reproduce.h"

#include <chrono>
#include <fstream>
#include <string_view>

#include "analysis/reproduce/runs.h"
#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

struct ExperimentEntry {
  const char* name;
  ReproduceFunction function;
  int runs;      // number of calls of ReproduceRuns::Run
  double share;  // share of the total time
};

constexpr ExperimentEntry kExperiments[] = {
    {"box_9kg", ReproduceBox9, 5, 0.03},
    {"box_18kg", ReproduceBox18, 5, 0.03},
    {"bar_circle", ReproduceBar, 3, 0.02},
    {"ablation", ReproduceAblation, 210, 0.40},
    {"safety", ReproduceSafety, 3, 0.01},
    {"tuning", ReproduceTuning, 17, 0.06},
    {"arms", ReproduceArms, 13, 0.06},
    {"relative_pose", ReproduceRelativePose, 3, 0.01},
    {"circle", ReproduceCircle, 3, 0.33},
    {"responsiveness", ReproduceResponsiveness, 1, 0.02},
    {"questionnaire", ReproduceQuestionnaire, 1, 0.01},
};

// Checked in advance, because a failure after the runs would waste minutes.
void MakeWritable(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path probe = folder / ".writable";
  if (error || !std::ofstream(probe))
    throw InputError(
        "'" + folder.string() +
        "' cannot be written. Use -o to give a folder that is writable or can be created.");
  std::filesystem::remove(probe, error);
}

// "AMD EPYC 7713 64-Core Processor".
std::string ProcessorModel() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    constexpr std::string_view kKey = "model name";
    const std::size_t colon = line.find(": ");
    if (line.compare(0, kKey.size(), kKey) == 0 && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "a processor of unknown model";
}

void CheckName(const std::string& only) {
  const std::vector<std::string> names = ReproducibleExperiments();
  if (only.empty()) return;
  for (const std::string& name : names)
    if (name == only) return;
  throw InputError("--only: there is no experiment " + Quote(only) + ". " +
                   Suggestion(only, names));
}

}  // namespace

std::vector<std::string> ReproducibleExperiments() {
  std::vector<std::string> names;
  for (const ExperimentEntry& entry : kExperiments) names.emplace_back(entry.name);
  return names;
}

Reproduction Reproduce(const ReproduceOptions& options) {
  CheckName(options.only);
  MakeWritable(options.folder);
  Reproduction result;
  result.machine = ProcessorModel();
  result.program_version = options.program_version;
  double before = 0;
  for (const ExperimentEntry& entry : kExperiments) {
    if (!options.only.empty() && options.only != entry.name) continue;
    ReproduceOptions within = options;
    const double share = options.only.empty() ? entry.share : 1;
    if (options.progress)
      within.progress = [&, before](double part, const std::string& what) {
        options.progress(before + share * part, what);
      };
    const auto start = std::chrono::steady_clock::now();
    ReproduceRuns runs(within, entry.name, entry.runs);
    result.experiments.push_back(entry.function(&runs));
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result.experiments.back().wall = wall.count();
    before += share;
  }
  return result;
}

}  // namespace predictor
