#include "commands.h"
#include "scenario/scenario_io.h"

namespace predictor {

void ScenarioOptions::AddTo(CLI::App* app) {
  app->add_option("scenario", file, "Scenario file (YAML)")->required();
  app->add_option("--set", set, "Override a value of the scenario: path.to.key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app->add_option("--seed", seed, "Seed of all random draws, instead of the scenario's");
  app->add_option("--duration", duration, "Seconds to run, instead of the scenario's");
  app->add_option("--summary", summary,
                  "Write the summary as JSON to this file; - for standard output");
  app->add_flag("--quiet", quiet, "No progress and no table");
}

Scenario ScenarioOptions::Load() const {
  std::vector<std::string> overrides = set;
  if (seed) overrides.push_back("seed=" + std::to_string(*seed));
  if (duration) overrides.push_back("duration=" + std::to_string(*duration));
  return LoadScenario(file, overrides);
}

}  // namespace predictor
