#include "analysis/check/check.h"

#include <filesystem>
#include <optional>

#include "analysis/stability_map/stability_map.h"
#include "commands.h"
#include "progress.h"
#include "scenario/machine.h"
#include "screen.h"

namespace predictor {
namespace {

// Writes a stability map and returns a message that describes it.
std::string MakeMap(const Scenario& scenario, const CheckMap& wanted, bool quiet) {
  Progress progress("Mapping", 1, quiet);
  const std::filesystem::path folder = wanted.folder;
  MapOptions how;
  how.folder = folder;
  how.only_walls = wanted.only_walls;
  how.progress = [&](double share, const std::string& what) { progress.Update(share, what); };
  const StabilityMap map = MakeStabilityMap(scenario, how);
  progress.Finish();
  WriteStabilityMap(map, folder);
  return MapText(map) + "  the page:        " + (folder / "index.html").string() + "\n";
}

}  // namespace

int CheckCommand(const ScenarioOptions& options, bool search, const CheckMap& map) {
  std::optional<Machine> machine;
  if (!options.machine.empty()) machine = LoadMachine(options.machine);
  const Scenario scenario = options.Load(machine ? &*machine : nullptr);
  Progress progress("Checking", 1, options.quiet);
  CheckOptions how;
  how.search = search;
  how.machine = machine ? &*machine : nullptr;
  how.progress = [&](double share, const char* what) { progress.Update(share, what); };
  const CheckReport report = Check(scenario, how);
  progress.Finish();
  std::string text = CheckText(report);
  if (options.quiet)
    for (const std::string& problem : report.problems) TheScreen().Print("Unfit: " + problem);
  if (!map.folder.empty()) text += MakeMap(scenario, map, options.quiet);
  options.Write(text, CheckJson(report));
  return report.fit() ? kFinished : kUnfit;
}

}  // namespace predictor
