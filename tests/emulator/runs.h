// Runs the project's scenarios from start to end in virtual time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/summary.h"
#include "scenario/scenario_io.h"

namespace predictor {

inline Scenario LoadTestScenario(const std::string& name,
                                 const std::vector<std::string>& set = {}) {
  return LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml", set);
}

struct TestRun {
  Summary summary;
  RunEnd end = RunEnd::kNotStarted;
  StopReport stop;
};

// Runs a scenario to its end and calls `look` with every record.
inline TestRun RunScenario(const std::string& name, const std::vector<std::string>& set = {},
                           const std::function<void(const TickRecord&)>& look = {}) {
  const Scenario scenario = LoadTestScenario(name, set);
  Emulator emulator(scenario);
  SummaryBuilder builder(scenario);
  TestRun run;
  run.end = Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    builder.Add(record);
    if (look) look(record);
  });
  run.summary = builder.summary();
  run.stop = emulator.stop();
  return run;
}

// Returns whether neither the emulator nor the cobot's own safety stopped the run.
inline bool EndsWell(const TestRun& run) {
  return run.summary.stop_count == 0 && !run.summary.cobot_stop;
}

inline Pose ObjectOf(const TickRecord& record) { return FromRecord(record.object.pose); }

}  // namespace predictor
