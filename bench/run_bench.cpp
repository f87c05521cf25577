#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/summary.h"
#include "samples.h"
#include "sections.h"

namespace predictor::bench {

RunTimes TimeRuns(const std::string& scenario, int runs) {
  std::array<std::vector<double>, kStages> p50, p99;
  std::vector<double> cpu_factor, wall_factor, start_up;
  for (int run = 0; run < runs; ++run) {
    std::unique_ptr<Emulator> emulator;
    start_up.push_back(1e-6 * Microseconds([&] {
                         emulator = std::make_unique<Emulator>(LoadNamed(scenario));
                         emulator->Tick();
                       }));
    const Scenario& s = emulator->scenario();
    SummaryBuilder summary(s);  // as in `simulate`
    std::array<std::vector<double>, kStages> us;
    const double cpu = CpuSeconds();
    double simulated = 0;
    const double wall = 1e-6 * Microseconds([&] {
                          Simulate(emulator.get(), s.duration, [&](const TickRecord& tick) {
                            summary.Add(tick);
                            if (tick.state != RunState::kRun) return;
                            simulated = tick.run_time;
                            for (std::size_t k = 0; k < kStages; ++k)
                              us[k].push_back(static_cast<double>(tick.stage_us[k]));
                          });
                        });
    cpu_factor.push_back(simulated / (CpuSeconds() - cpu));
    wall_factor.push_back(simulated / wall);
    for (std::size_t k = 0; k < kStages; ++k) {
      p50[k].push_back(Median(us[k]));
      p99[k].push_back(Quantile(us[k], 0.99));
    }
  }
  RunTimes times;
  for (std::size_t k = 0; k < kStages; ++k) {
    times.p50[k] = Median(p50[k]);
    times.p99[k] = Median(p99[k]);
  }
  times.cpu_factor = Median(cpu_factor);
  times.wall_factor = Median(wall_factor);
  times.start_up = Median(start_up);
  return times;
}

}  // namespace predictor::bench
