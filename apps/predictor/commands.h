// The subcommands of `predictor`: each takes its options and returns an exit code. What the command
// line looks like is told in main.cpp alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recorded_run.h"
#include "ros_tcp/ros_tcp_process.h"
#include "scenario/machine.h"
#include "scenario/scenario.h"
#include "viewer/viewer_process.h"

namespace predictor {

// Exit codes, a contract with scripts.
enum ExitCode {
  kFinished = 0,
  kSafetyStop = 1,
  kUnfit = 1,
  kDeparted = 1,
  kBadInput = 2,
  kDeviceFailure = 3
};

// Options that every command on a scenario takes.
struct ScenarioOptions {
  std::string file;
  std::vector<std::string> set;
  std::optional<std::string> seed, duration;  // values of these keys, as they were typed
  std::string summary;                        // file, "-" for standard output, empty for none
  bool quiet = false;
  std::string machine;  // file of the real arms; empty: the scenario's own device

  // Throws InputError: of the scenario, and if the summary could not be written later. `on`: its
  // arms take the place of the scenario's.
  Scenario Load(const Machine* on = nullptr) const;
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

// What `export-data` takes out of a recording.
struct ExportDataOptions {
  std::string recording;
  std::vector<std::string> channels;  // patterns of names; none: all
  std::string output;                 // empty or "-": standard output
  std::uint64_t every = 1;            // ticks a row
  bool list = false;                  // only the names
  bool events = false;                // what happened, instead of channels
  bool quiet = false;
};

// What `identify` reads and writes.
struct IdentifyCommandOptions {
  std::string recording;
  std::string scenario;            // which is believed; empty: the recording's own
  std::string output;              // scenario with the friction; empty: none
  bool force = false;              // `output` may exist
  std::string summary;             // file, "-" for standard output, empty for none
  double mass_uncertainty = 0.03;  // of the links, standard deviations
  double com_uncertainty = 0.005;  // [m]
  bool quiet = false;
};

// Where `export-scene` writes.
struct ExportOptions {
  std::string folder;  // empty: named after the scenario, in the current folder
  bool force = false;  // the folder need not be empty
};

// What `survey` does: asks, unless told to do one of the others.
struct SurveyOptions {
  std::vector<std::string> places;  // a recording to ask about; or answers and folders with answers
  std::string condition;            // "real", "emulated"; empty: the person is asked
  std::uint16_t port = 8081;        // 0: any; a run's page may be open at 8080
  bool report = false, paper = false;
  std::string output;  // of the report; empty: survey.html
  std::string remove;  // a pseudonym
};

// What `report` reads and writes.
struct ReportOptions {
  std::vector<std::string> recordings;
  std::string output;  // empty: named after the recording; of several comparison.html
  std::string svg;     // folder for the plots as files; empty: none
  bool quiet = false;
};

// What `compare` reads and writes.
struct CompareOptions {
  std::vector<std::string> a, b;           // the first of each is compared, the others are repeats
  bool by_phase = false, by_time = false;  // neither: as the paths allow
  std::string summary;                     // file, "-" for standard output, empty for none
  bool quiet = false;
};

// What `reproduce` runs and where it writes.
struct ReproduceCommandOptions {
  std::string folder = "reproduction";
  std::string scenarios = "scenarios";
  std::string only;  // name of the one experiment; empty: all
  bool quiet = false;
};

// What `devices` looks at.
struct DevicesOptions {
  std::string machine;
  double duration = 2;  // for which each device is watched [s]
};

// What `calibrate` measures.
struct CalibrateOptions {
  std::string what;            // handle, bases, loop, push
  std::string machine;         // is changed
  std::string arm;             // left, right; empty: the only one, or both
  std::optional<Vector3> tip;  // bases: of what touches, in E [m]; none: the person is asked
};

// Writes `text` to standard output. Throws std::runtime_error if it does not get there.
void WriteOut(const std::string& text);
// What is wrong with a recording, to standard error; nothing if that is empty.
void TellProblem(const std::string& problem);

// Each throws InputError.
int RunCommand(const ScenarioOptions& options, ServeOptions serve, RecordOptions record);
int SimulateCommand(const ScenarioOptions& options, const RecordOptions& record);
// `map`: folder of a stability map, empty for none.
int CheckCommand(const ScenarioOptions& options, bool search, const std::string& map);
int ExportSceneCommand(const ScenarioOptions& options, const ExportOptions& to);
// machine: of machine files.
int SchemaCommand(bool machine);
int ReportCommand(const ReportOptions& options);
int CompareCommand(const CompareOptions& options);
int ExportDataCommand(const ExportDataOptions& options);
// `output`: empty for the recording's name with ".recovered.mcap".
int RecoverCommand(const std::string& recording, const std::string& output);
// A recording in the viewer, until asked to end.
int ReplayCommand(const std::string& recording, const ViewerOptions& options);
// Exit code kDeparted if the run computed again is another.
int VerifyCommand(const std::string& recording, bool quiet);
// Exit code kUnfit if a joint was refused.
int IdentifyCommand(const IdentifyCommandOptions& options);
int ReproduceCommand(const ReproduceCommandOptions& options);
int SurveyCommand(const SurveyOptions& options);
// Exit code kDeviceFailure if a device does not answer as it must, kBadInput if one is not what the
// machine file says.
int DevicesCommand(const DevicesOptions& options);
int CalibrateCommand(const CalibrateOptions& options);

}  // namespace predictor
