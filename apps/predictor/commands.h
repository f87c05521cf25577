// The commands of `predictor`: each function takes its options and returns an exit code. The
// command line itself is in command_line.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab_streams/stream_process.h"
#include "recorded_run.h"
#include "ros_tcp/ros_tcp_process.h"
#include "scenario/machine.h"
#include "scenario/scenario.h"
#include "viewer/viewer_process.h"

namespace predictor {

// Exit codes, on which scripts rely:
// 0: success;
// 1: the command worked, but its result is negative (a safety stop without a reset, a scenario that
// fails its check, a replay that differs, a joint that was not identified, a device that differs
// from the machine file);
// 2: bad input or usage;
// 3: a device, the system, the program or a controller's library failed.
enum ExitCode {
  kFinished = 0,
  kSafetyStop = 1,
  kUnfit = 1,
  kDeparted = 1,
  kBadInput = 2,
  kDeviceFailure = 3
};

// The destination of a command's result.
struct OutputOptions {
  std::string json;    // file for the result as JSON; "-": standard output; empty: none
  bool quiet = false;  // no progress and no result as text
  bool force = false;  // existing files may be replaced

  // Throws InputError if the file `json` cannot be written, or if it exists and may not be
  // replaced.
  void CheckWritable() const;
  // Throws InputError if the file exists and may not be replaced. The names "" and "-" do not
  // denote files.
  void RefuseToReplace(const std::string& file) const;
  // Does the same as RefuseToReplace, and also removes an existing file that may be replaced. Use
  // this function for outputs that must be new files.
  void MakeRoom(const std::string& file) const;
  // Prints text for the user unless quiet. The text is printed to standard error if standard output
  // gets the JSON.
  void Print(const std::string& text) const;
  // Writes a command's result to `json`.
  void WriteJson(const std::string& result) const;
  // Prints the text and writes the JSON result.
  void Write(const std::string& text, const std::string& result) const;
};

// Options of all commands that use a scenario.
struct ScenarioOptions : OutputOptions {
  std::string file;
  std::vector<std::string> set;
  std::optional<std::string> seed, duration;  // values of these keys, as typed
  std::string machine;  // machine file of the real arms; empty: the scenario's own device

  // Loads the scenario. Throws InputError if the scenario is invalid, or if the JSON file cannot be
  // written. `on` is a machine whose arms replace the arms of the scenario.
  Scenario Load(const Machine* on = nullptr) const;
};

// The servers that `run` starts alongside the loop.
struct ServeOptions {
  bool viewer = true;
  // States whether, after the run, the program waits with the arms at rest until the user ends the
  // program. By default, the program waits if it runs at a terminal, and also while a page shows
  // the results.
  std::optional<bool> stay;
  viewer::ViewerOptions page;
  bool evaluation = true;  // the person is judged live, if the scenario describes the person
  lab_streams::StreamOptions streams;  // that measure the person
  bool ros_tcp = false;
  ros_tcp::RosTcpOptions ros;
};

// The recording to read, and the data to take from this recording.
struct RecordingOptions : OutputOptions {
  std::string recording;
  std::vector<std::string> channels;  // export data: patterns of names; empty: all
  std::string output;                 // empty: the command's default file or stream
  std::uint64_t every = 1;            // export data: ticks per row
};

// Input and output of `identify`.
struct IdentifyCommandOptions : OutputOptions {
  std::string recording;
  std::string scenario;            // nominal values; empty: those of the recording
  std::string output;              // scenario file to write, including the friction; empty: none
  double mass_uncertainty = 0.03;  // standard deviation of the links' masses
  double com_uncertainty = 0.005;  // [m]
};

// Input and output of `identify-arm`.
struct IdentifyArmOptions : OutputOptions {
  std::vector<std::string> recordings;  // of one person
  std::string left, right;              // files with the distribution of a hand; empty: none
};

// Output of `export scene`.
struct ExportOptions {
  std::string folder;  // empty: named after the scenario, in the current folder
  bool sdf = false;    // SDF for Gazebo instead of URDF
};

// Input and output of the `survey` commands.
struct SurveyOptions : OutputOptions {
  // The recording to which the questionnaire refers, or files and folders with answers.
  std::vector<std::string> places;
  std::string condition;      // "real", "emulated"; empty: the page asks the person
  std::uint16_t port = 8081;  // 0: any free port; the page of a run may use 8080
  std::string output = "survey.html";
  std::string pseudonym;  // pseudonym of the person whose answers are removed
};

// Input and output of `report`.
struct ReportOptions : OutputOptions {
  std::vector<std::string> recordings;
  std::string output;            // empty: named after the recording; for several: comparison.html
  std::vector<std::string> set;  // overrides of the recorded scenario, for body and stance
};

// Input and output of `compare`.
struct CompareOptions : OutputOptions {
  std::vector<std::string> a, b;  // the first of each list is compared, the others are repeats
  bool by_phase = false, by_time = false;  // if both are false, the paths decide
};

// Experiments and output of `reproduce`.
struct ReproduceCommandOptions : OutputOptions {
  std::string folder = "reproduction";
  std::string scenarios = "scenarios";
  std::vector<std::string> set;
  std::string only;  // name of a single experiment; empty: all
};

// The person who held the handles in a recording.
struct PersonOptions : OutputOptions {
  std::vector<std::string> set;     // overrides of the recorded scenario, for body and stance
  std::vector<std::string> tracks;  // files with further measurements of the person
};

// Input and output of `evaluate`.
struct EvaluateOptions : PersonOptions {
  // With several recordings, `page`, `csv` and `json` name folders.
  std::vector<std::string> recordings;
  std::string against;                      // a recording of another design; empty: none
  std::vector<std::string> against_tracks;  // further measurements of its person
  bool intervals = true;
  bool repeated = false, held = false;  // see assessment::WorkPattern
  std::string lifting = "1h";           // duration of the work with lifts
  std::string coupling = "good";        // of hands and handles
  std::optional<double> grip_effort;    // 0 … 10
  std::vector<double> fatigue_trial;    // share of strength, and time [s]; empty: no trial
  std::string arm_model;                // MyoArm, folder or MJCF; empty: the built-in model
  std::vector<std::string> limits;      // files of limits that a run must keep
  std::string contact_limits;           // file of limits for unintended contact; empty: none
  std::string page;                     // empty: NAME.person.html
  std::string csv;                      // empty: no table
};

// Input and output of `continue`.
struct ContinueCommandOptions : OutputOptions {
  std::string recording;
  std::string arm;  // file with the distribution of the arm's impedance; empty: the prior
  int draws = 200;
  double horizon = 1.5;    // [s]
  std::uint64_t seed = 1;  // seed of the possible operators
  std::string page;        // empty: NAME.continued.html
};

// Output of `export person`.
struct ExportPersonOptions : PersonOptions {
  std::string recording;
  std::string folder;  // empty: NAME.opensim
};

// A stability map that `check` makes.
struct CheckMap {
  std::string folder;  // empty: none
  bool only_walls = false;
};

// Input and output of `import`.
struct ImportOptions : OutputOptions {
  std::string file;    // of another system
  std::string map;     // mapping, YAML
  std::string output;  // empty: NAME.person.csv
};

// Input of `forget`.
struct ForgetOptions : OutputOptions {
  std::string pseudonym;
  std::string folder;
  bool yes = false;  // delete without asking
};

// Input and output of `hazards`.
struct HazardsCommandOptions : OutputOptions {
  std::vector<std::string> scenarios;
  std::string folder = "hazards";
  int seeds = 50;  // runs of each scenario, controller and hazard
};

// Input and output of `population`.
struct PopulationCommandOptions : OutputOptions {
  std::vector<std::string> scenarios;
  std::vector<std::string> set;  // overrides of all scenarios
  std::vector<double> heights;   // heights of the handles above the ground [m]
  std::string folder = "population";
  int persons = 200;
  std::uint64_t seed = 1;  // seed of the population
  int workers = 0;         // 0: the number of cores
};

// Output of `init`.
struct InitOptions : OutputOptions {
  std::string name;  // name of the scenario, and of its file without .yaml
  int arms = 2;
  std::string urdf;            // URDF of the cobot; empty: a Franka Panda
  std::string end_effector;    // link of the cobot; empty: see FindArm
  std::string object = "box";  // box, bar or ball
};

// Input of `devices`.
struct DevicesOptions : OutputOptions {
  std::string machine;
  double duration = 2;  // observation time of each device [s]
};

// Input of `calibrate`.
struct CalibrateOptions : OutputOptions {
  std::string what;            // step: handle, bases, loop or push
  std::string machine;         // file that the command changes
  std::string arm;             // left, right; empty: the only one, or both
  std::optional<Vector3> tip;  // bases: touching point in E [m]; empty: the person is asked
};

// Writes `text`, made printable, to standard output. Throws std::runtime_error on a write error.
void WriteOut(const std::string& text);
// Prints the description of a recording's problem to standard error, unless the description is
// empty.
void ShowProblem(const std::string& problem);

// Every command throws InputError.
int RunCommand(const ScenarioOptions& options, ServeOptions serve, RecordOptions record);
int SimulateCommand(const ScenarioOptions& options, const RecordOptions& record);
int CheckCommand(const ScenarioOptions& options, bool search, const CheckMap& map);
int ExportSceneCommand(const ScenarioOptions& options, const ExportOptions& to);
// Returns the exit code kUnfit if the scenario that the command wrote does not pass its check.
int InitCommand(const InitOptions& options);
int ReportCommand(const ReportOptions& options);
int CompareCommand(const CompareOptions& options);
int ExportDataCommand(const RecordingOptions& options);
int ExportEventsCommand(const RecordingOptions& options);
int ListChannelsCommand(const RecordingOptions& options);
// Return a table of the reference as JSON.
std::string QuantitiesReference();
std::string ConsoleReference();
// Writes the repaired recording to `output`, or to NAME.repaired.mcap next to the recording if
// `output` is empty.
int RepairCommand(const RecordingOptions& options);
// Writes the copy to `output`, or to NAME.shared.mcap next to the recording if `output` is empty.
int ShareCommand(const RecordingOptions& options);
// Returns the exit code kUnfit if data of the person remain, or if a place could not be searched.
int ForgetCommand(const ForgetOptions& options);
// Shows a recording in the viewer until the user ends the program.
int ReplayCommand(const RecordingOptions& recording, const ServeOptions& options);
// Returns the exit code kDeparted if the recomputed run differs.
int VerifyCommand(const RecordingOptions& options);
// Tests the library of a controller with a recorded run. Returns the exit code kUnfit if the
// library fails the trial.
int TrialCommand(const ScenarioOptions& options, const std::string& recording);
// Returns the exit code kUnfit if a joint was rejected.
int IdentifyCommand(const IdentifyCommandOptions& options);
// Returns the exit code kUnfit if a hand was refused.
int IdentifyArmCommand(const IdentifyArmOptions& options);
int EvaluateCommand(const EvaluateOptions& options);
int ContinueCommand(const ContinueCommandOptions& options);
int ExportPersonCommand(const ExportPersonOptions& options);
int ImportCommand(const ImportOptions& options);
int HazardsCommand(const HazardsCommandOptions& options);
int PopulationCommand(const PopulationCommandOptions& options);
int ReproduceCommand(const ReproduceCommandOptions& options);
int SurveyAskCommand(const SurveyOptions& options);
int SurveyReportCommand(const SurveyOptions& options);
int SurveyRemoveCommand(const SurveyOptions& options);
int SurveyPaperCommand();
// Returns the exit code kDeviceFailure if a device does not answer correctly, and kUnfit if a
// device differs from the machine file.
int DevicesCommand(const DevicesOptions& options);
int CalibrateCommand(const CalibrateOptions& options);

}  // namespace predictor
