// The subcommands of `predictor`. Each adds itself to the command line and sets what to run.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// Exit codes, a contract with scripts.
enum ExitCode { kFinished = 0, kSafetyStop = 1, kUnfit = 1, kBadInput = 2, kDeviceFailure = 3 };

using Command = std::function<int()>;

// Options that every command on a scenario takes.
struct ScenarioOptions {
  std::string file;
  std::vector<std::string> set;
  std::optional<std::uint64_t> seed;
  std::optional<double> duration;
  std::string summary;  // file, "-" for standard output, empty for none
  bool quiet = false;

  void AddTo(CLI::App* app);
  // Throws InputError.
  Scenario Load() const;
};

void AddRun(CLI::App* app, Command* command);
void AddSimulate(CLI::App* app, Command* command);
void AddCheck(CLI::App* app, Command* command);
void AddSchema(CLI::App* app, Command* command);

}  // namespace predictor
