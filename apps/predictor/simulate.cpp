#include <chrono>
#include <cstdio>

#include "commands.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "progress.h"
#include "report.h"

namespace predictor {

int SimulateCommand(const ScenarioOptions& options) {
  const Scenario scenario = options.Load();
  Emulator emulator(scenario);
  PrintSetup(emulator, options.quiet);
  SummaryBuilder builder(scenario);
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

}  // namespace predictor
