// The command line: its commands and options, its help, and its error messages. The functions that
// execute the commands are declared in commands.h.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "commands.h"

namespace predictor {

// Contains the values of all options and the chosen command.
struct Request {
  ScenarioOptions scenario;
  ServeOptions serve;
  RecordOptions record;
  RecordingOptions recording;
  ExportOptions scene;
  IdentifyCommandOptions identify;
  IdentifyArmOptions identify_arm;
  ReportOptions report;
  CompareOptions compare;
  ReproduceCommandOptions reproduce;
  EvaluateOptions evaluate;
  ContinueCommandOptions continue_run;
  ExportPersonOptions person;
  ImportOptions imported;
  ForgetOptions forget;
  HazardsCommandOptions hazards;
  PopulationCommandOptions population;
  SurveyOptions survey;
  DevicesOptions devices;
  CalibrateOptions calibrate;
  InitOptions init;
  OutputOptions printed;  // of the commands that print one line
  std::vector<double> tip;
  bool search = true;
  CheckMap map;
  std::vector<std::string> help;  // command whose help is requested
  std::function<int()> command;
};

// Each of these functions adds a group of commands. `r` must outlive `app`.
void AddRunCommands(CLI::App* app, Request* r);
void AddAnalysisCommands(CLI::App* app, Request* r);
void AddRigCommands(CLI::App* app, Request* r);
void AddToolCommands(CLI::App* app, Request* r);

// Adds a command, which `run` executes.
CLI::App* AddCommand(CLI::App* app, const char* group, const char* name, const char* what,
                     Request* r, std::function<int()> run);
// Adds an option. `type` is the name of the option's value in the help.
template <class T>
CLI::Option* AddOption(CLI::App* app, const char* group, const char* name, T* value,
                       const char* type, const char* what) {
  return app->add_option(name, *value, what)->type_name(type)->group(group);
}
// Adds an option that the user can repeat. Each time, the option takes one value. Without this
// limit, the option would also take the files that follow the value.
template <class T>
CLI::Option* AddRepeatable(CLI::App* app, const char* group, const char* name,
                           std::vector<T>* values, const char* type, const char* what) {
  return AddOption(app, group, name, values, type, what)
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
}

// Options that several commands share.
void AddPersonOverrides(CLI::App* app, std::vector<std::string>* set);
// Adds the options --set and --track, which describe the person in a recording.
void AddPerson(CLI::App* app, PersonOptions* o);
void AddScenario(CLI::App* app, ScenarioOptions* o);
void AddRecording(CLI::App* app, std::string* recording);
// Adds the options --json, --force and --quiet.
void AddOutput(CLI::App* app, OutputOptions* o);
void AddJson(CLI::App* app, OutputOptions* o);
void AddQuiet(CLI::App* app, OutputOptions* o);
void AddForce(CLI::App* app, OutputOptions* o);
void AddPageOptions(CLI::App* app, ServeOptions* o);
CLI::Option* AddPort(CLI::App* app, const char* group, const char* name, std::uint16_t* port,
                     const char* what);

// Formats help as text, wrapped to the terminal's width (80 to 100 columns), with options and
// commands in groups.
class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
};

// Returns the same help in groff, as a manual page for man(1).
std::string ManPage(const CLI::App& app);
// Returns a script that completes commands and options in bash.
std::string BashCompletion(const CLI::App& app);

// Returns the full name of a command, for example "predictor survey ask".
std::string PathOf(const CLI::App& app);
// Returns the commands that the help shows.
std::vector<const CLI::App*> CommandsOf(const CLI::App& app);
std::vector<std::string> CommandNames(const CLI::App& app);
// Returns long names of an option as shown in the help: "--json", "--[no-]viewer".
std::string LongNameOf(const CLI::Option& option);

// Returns an error message and a hint ("predictor: error: ..." and "hint: ...") for a command that
// `app` does not have.
std::string UnknownCommand(const CLI::App& app, const std::string& word);
// Returns the error and hint for a command line that cannot be parsed.
std::string UsageError(const CLI::App& app, const CLI::ParseError& error);

// Returns the versions as text, for example "predictor 0.1.0 (a1b2c3d), recording format 2, MuJoCo
// 4.0.0, DART 6.12.1".
std::string VersionText();

}  // namespace predictor
