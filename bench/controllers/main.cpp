// Measures the time that a controller outside the program adds to a tick. The built-in controller
// and a library in C compute the same torques for the same scene and take turns in each tick.
// Afterwards, a Python process computes the torques in virtual time, in which the tick waits for
// the process.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

constexpr int kTicks = 100'000;

// The cobot carries its own weight, and a table carries the object.
Scenario OnTable(const std::string& controller) {
  const std::string source = PREDICTOR_SOURCE_DIR;
  return LoadScenario(source + "/scenarios/box_9kg.yaml",
                      {"cobot.controller=" + controller, "duration=1000", "operator.script=[]",
                       "environment.table={size: [2, 2, 0.05], top: [0.5, 0, 0.95]}"});
}

double Median(std::vector<float> x) {
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

void Main() {
  setenv("PREDICTOR_PACKAGE_PATH", PREDICTOR_PLUGINS, 1);
  const std::string none = "parameters: joint_stiffness=0 damping_rate=0";
  const std::array<const char*, 3> names = {"in the program", "library in C", "process in Python"};
  const std::array<std::string, 3> controllers = {
      "{type: gravity_compensation}",
      "{type: plugin, library: package://plugins/joint_impedance.so, " + none + "}",
      "{type: process, command: [python3, " PREDICTOR_SOURCE_DIR
      "/examples/plugins/joint_impedance.py], " +
          none + "}"};
  std::array<std::unique_ptr<Emulator>, 3> runs;
  std::array<std::vector<float>, 3> tick, simulate;
  for (std::size_t i = 0; i < runs.size(); ++i)
    runs[i] = std::make_unique<Emulator>(OnTable(controllers[i]));
  std::size_t different = 0;
  const auto step = [&](std::size_t i) {
    runs[i]->Tick();
    AutoStart(runs[i].get());
    const TickRecord& record = runs[i]->record();
    if (record.state != RunState::kRun) return;
    tick[i].push_back(record.stage_us[static_cast<std::size_t>(Stage::kTick)]);
    simulate[i].push_back(record.stage_us[static_cast<std::size_t>(Stage::kSimulate)]);
  };
  for (std::size_t k = 0; k < kTicks; ++k) {
    step(k % 2);
    step((k + 1) % 2);
    if (runs[0]->record().cobot_torque != runs[1]->record().cobot_torque) ++different;
  }
  for (int k = 0; k < kTicks; ++k) step(2);
  std::printf("%-18s %10s %10s %12s\n", "controller", "tick us", "simulate", "tick, added");
  for (std::size_t i = 0; i < runs.size(); ++i)
    std::printf("%-18s %10.2f %10.2f %11.1f%%\n", names[i], Median(tick[i]), Median(simulate[i]),
                100 * (Median(tick[i]) / Median(tick[0]) - 1));
  std::printf("Medians of %zu ticks. Ticks with other torques: %zu.\n", tick[0].size(), different);
}

}  // namespace
}  // namespace predictor

int main() {
  try {
    predictor::Main();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_controllers: %s\n", error.what());
    return 2;
  }
}
