#include "analysis/reproduce/reproduce.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string_view>

#include "analysis/reproduce/runs.h"
#include "core/error.h"
#include "core/text.h"
#include "scenario/scenario_io.h"
#include "simulation/engine_version.h"

namespace predictor {
namespace {

struct ExperimentEntry {
  const char *name, *title;
  ReproduceFunction function;
  int runs;      // number of calls of ReproduceRuns::Run
  double share;  // share of the total time
};

constexpr ExperimentEntry kExperiments[] = {
    {"box_9kg", "Scenario 1 (Figs 5, 7, 8)", ReproduceBox9, 5, 0.03},
    {"box_18kg", "Scenario 2 (Figs 6, 7)", ReproduceBox18, 5, 0.03},
    {"bar_circle", "The bar along the circle (Fig. 10)", ReproduceBar, 3, 0.02},
    {"ablation", "The paper's formulation, and the effect of each repair", ReproduceAblation, 210,
     0.39},
    {"repairs", "Repairs that act in constructed starts only", ReproduceRepairs, 8, 0.01},
    {"safety", "Safety (Fig. 9)", ReproduceSafety, 3, 0.01},
    {"tuning", "Tuned values, and the result without them", ReproduceTuning, 17, 0.06},
    {"arms", "Arms other than assumed", ReproduceArms, 13, 0.06},
    {"relative_pose", "Relative pose (Fig. 4)", ReproduceRelativePose, 3, 0.01},
    {"circle", "Real and emulated (Fig. 12)", ReproduceCircle, 3, 0.33},
    {"responsiveness", "Responsiveness", ReproduceResponsiveness, 1, 0.02},
    {"questionnaire", "Questionnaire (Table 1, Fig. 11)", ReproduceQuestionnaire, 1, 0.01},
};

// The program checks the folder in advance, because a failure after the runs would waste minutes.
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

// Returns the name of the processor, for example "AMD EPYC 7713 64-Core Processor".
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
  if (std::ranges::find(names, only) != names.end()) return;
  throw InputError("--only: there is no experiment " + Quote(only) + ". " +
                   Suggestion(only, names));
}

// Names the engine that simulates the runs. The options change it in all scenarios alike.
std::string EngineOf(const ReproduceOptions& options) {
  const std::filesystem::path file = options.scenarios / "box_9kg.yaml";
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return "";
  const SimulationSpec simulation = LoadScenario(file, options.set).simulation;
  const bool is_limited = simulation.velocity_limits == VelocityLimits::kHard;
  return EngineVersion(simulation.engine) +
         (is_limited ? ", with hard limits" : ", without limits") +
         " of the cobot's joint velocities";
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
  result.engine = EngineOf(options);
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
    ReproducedExperiment& done = result.experiments.emplace_back(entry.function(&runs));
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    done.name = entry.name;
    done.title = entry.title;
    done.wall = wall.count();
    before += share;
  }
  return result;
}

}  // namespace predictor
