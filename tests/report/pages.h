// Simulates runs and provides their data in the form that a report uses.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "models/arm_model.h"
#include "report/report.h"
#include "report/run_data.h"
#include "scenario/scenario_io.h"

namespace predictor {

struct CollectedRun {
  RunData data;
  StopReport stop;
  double dissipated = 0;
};

inline RunInfo TestInfo(const Scenario& scenario, const std::string& name) {
  RunInfo info;
  info.name = name;
  info.scenario = scenario;
  info.scenario_yaml = SaveScenario(scenario);
  info.program_version = "test";
  return info;
}

// Runs `seconds` of one of the project's scenarios in virtual time.
inline CollectedRun Collect(const std::string& scenario_name, double seconds,
                            const std::vector<std::string>& set = {},
                            const ReadOptions& options = {}) {
  const Scenario scenario = LoadScenario(
      std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + scenario_name + ".yaml", set);
  Emulator emulator(scenario);
  RunInfo info = TestInfo(scenario, scenario_name);
  info.prismatic = PrismaticJoints(scenario);
  RunCollector collector(std::move(info), options);
  Simulate(&emulator, seconds, [&](const TickRecord& record) { collector.Add(record); });
  return {collector.Finish(), emulator.stop()};
}

// Saves the report in PREDICTOR_REPORTS, if that is set, so that a person can inspect it.
inline void Keep(const ReportDocument& report, const std::string& name) {
  const char* folder = std::getenv("PREDICTOR_REPORTS");
  if (!folder) return;
  std::filesystem::create_directories(folder);
  std::ofstream(std::filesystem::path(folder) / (name + ".html")) << report.html;
}

}  // namespace predictor
