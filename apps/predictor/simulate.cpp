#include <chrono>
#include <optional>

#include "commands.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "progress.h"
#include "report.h"
#include "screen.h"

namespace predictor {

int SimulateCommand(const ScenarioOptions& options, const RecordOptions& record) {
  const Scenario scenario = options.Load();
  Emulator emulator(scenario);
  PrintSetup(emulator, options.quiet);
  std::optional<VirtualRecording> recording;
  if (!record.file.empty()) {
    options.MakeRoom(record.file);
    recording.emplace(&emulator, record);
  }
  SummaryBuilder builder(scenario);
  Progress progress("Simulating", scenario.duration, options.quiet);
  const auto start = std::chrono::steady_clock::now();
  const RunEnd end = Simulate(&emulator, scenario.duration, [&](const TickRecord& tick) {
    builder.Add(tick);
    if (recording) recording->Add(tick);
    if (tick.tick % 256 == 0) progress.Update(tick.run_time);
  });
  progress.Finish();
  if (recording) recording->Close();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  if (recording && !options.quiet) TheScreen().Print(recording->Summary());
  Summary summary = builder.summary();
  return Report(emulator, end, wall.count(), options, &summary);
}

}  // namespace predictor
