#include <chrono>
#include <cstdio>

#include "commands.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "progress.h"
#include "report.h"

namespace predictor {
namespace {

int SimulateScenario(const ScenarioOptions& options) {
  const Scenario scenario = options.Load();
  Emulator emulator(scenario);
  PrintSetup(emulator, options.quiet);
  SummaryBuilder builder(scenario.name, scenario.seed, scenario.safety.force,
                         scenario.safety.torque);
  Progress progress("Simulating", scenario.duration, options.quiet);
  const auto start = std::chrono::steady_clock::now();
  const RunEnd end = Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    builder.Add(record);
    if (record.tick % 256 == 0) progress.Update(record.run_time);
  });
  progress.Finish();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return Report(emulator, end, wall.count(), options, &builder.summary());
}

}  // namespace

void AddSimulate(CLI::App* app, Command* command) {
  CLI::App* simulate =
      app->add_subcommand("simulate", "Run a scenario in virtual time and print its summary");
  auto options = std::make_shared<ScenarioOptions>();
  options->AddTo(simulate);
  simulate->callback(
      [command, options] { *command = [options] { return SimulateScenario(*options); }; });
}

}  // namespace predictor
