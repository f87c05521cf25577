// The subcommands of `predictor`: each takes its options and returns an exit code. What the command
// line looks like is told in main.cpp alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ros_tcp/ros_tcp_server.h"
#include "scenario/scenario.h"
#include "viewer/viewer_process.h"

namespace predictor {

// Exit codes, a contract with scripts.
enum ExitCode { kFinished = 0, kSafetyStop = 1, kUnfit = 1, kBadInput = 2, kDeviceFailure = 3 };

// Options that every command on a scenario takes.
struct ScenarioOptions {
  std::string file;
  std::vector<std::string> set;
  std::optional<std::string> seed, duration;  // values of these keys, as they were typed
  std::string summary;                        // file, "-" for standard output, empty for none
  bool quiet = false;

  // Throws InputError: of the scenario, and if the summary could not be written later.
  Scenario Load() const;
  // A command's result: `text` for people unless quiet, and `json` where `summary` says.
  void Write(const std::string& text, const std::string& json) const;
};

// What `run` serves beside the loop.
struct ServeOptions {
  bool viewer = true;
  bool stay = false;  // once at rest, until asked to end
  ViewerOptions page;
  bool ros_tcp = false;
  RosTcpOptions ros;
};

// Where `export-scene` writes.
struct ExportOptions {
  std::string folder;  // empty: named after the scenario, in the current folder
  bool force = false;  // the folder need not be empty
};

// Writes `text` to standard output. Throws std::runtime_error if it does not get there.
void WriteOut(const std::string& text);

// Each throws InputError.
int RunCommand(const ScenarioOptions& options, ServeOptions serve);
int SimulateCommand(const ScenarioOptions& options);
int CheckCommand(const ScenarioOptions& options, bool search);
int ExportSceneCommand(const ScenarioOptions& options, const ExportOptions& to);
int SchemaCommand();

}  // namespace predictor
