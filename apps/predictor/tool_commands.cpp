// The commands that convert recordings and print descriptions.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "analysis/check/check.h"
#include "analysis/continuation/continuation.h"
#include "analysis/population/population.h"
#include "assessment/output.h"
#include "command_line.h"
#include "evaluation/summary.h"
#include "scenario/machine.h"
#include "scenario/pseudonym.h"
#include "scenario/scenario_io.h"
#include "screen.h"

namespace predictor {
namespace {

constexpr const char* kToolGroup = "Tools";

void AddTable(CLI::App* app, RecordingOptions* o) {
  AddOption(app, "Output", "-o,--output", &o->output, "FILE.csv",
            "File to write [default: standard output]");
  AddJson(app, o);
  AddForce(app, o);
  AddQuiet(app, o);
}

void AddExport(CLI::App* app, Request* r) {
  CLI::App* all =
      app->add_subcommand(
             "export",
             "Export recordings as CSV, the person for OpenSim, or the scene as URDF or SDF")
          ->group(kToolGroup)
          ->require_subcommand(1);
  RecordingOptions* o = &r->recording;
  CLI::App* data = AddCommand(all, "Commands", "data", "Channels of a recording as CSV", r,
                              [o] { return ExportDataCommand(*o); });
  AddRecording(data, &o->recording);
  data->add_option("channels", o->channels,
                   "Names of channels or groups; * matches anything [default: all]");
  data->add_option("--every", o->every, "Number of ticks per row")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("TICKS")
      ->capture_default_str();
  AddTable(data, o);
  data->footer("Example:\n  predictor export data run.mcap cobot.q 'hands.*.wrench' -o run.csv\n");

  CLI::App* events =
      AddCommand(all, "Commands", "events", "Events of a recording as CSV: tick, time, kind, text",
                 r, [o] { return ExportEventsCommand(*o); });
  AddRecording(events, &o->recording);
  AddTable(events, o);
  events->footer("Example:\n  predictor export events run.mcap -o events.csv\n");

  CLI::App* channels = AddCommand(all, "Commands", "channels", "Names and units of the channels", r,
                                  [o] { return ListChannelsCommand(*o); });
  AddRecording(channels, &o->recording);
  AddOutput(channels, o);
  channels->footer("Example:\n  predictor export channels run.mcap\n");

  ExportPersonOptions* p = &r->person;
  CLI::App* person =
      AddCommand(all, "Commands", "person",
                 "The body, its motion and the forces of the hands in a recording, for OpenSim", r,
                 [p] { return ExportPersonCommand(*p); });
  AddRecording(person, &p->recording);
  AddPerson(person, p);
  AddOption(person, "Output", "-o,--output", &p->folder, "FOLDER",
            "Folder to write [default: NAME.opensim]");
  AddOutput(person, p);
  person->footer("Example:\n  predictor export person run.mcap -o run.opensim\n");

  CLI::App* scene =
      AddCommand(all, "Commands", "scene",
                 "The virtual scene as one URDF or SDF file with its meshes, for Unity or Gazebo",
                 r, [r] { return ExportSceneCommand(r->scenario, r->scene); });
  AddScenario(scene, &r->scenario);
  AddOption(scene, "Output", "-o,--output", &r->scene.folder, "FOLDER",
            "Folder to write [default: SCENARIO_scene]");
  scene->add_flag("--sdf", r->scene.sdf, "Write SDF 1.9 for Gazebo instead of URDF")
      ->group("Output");
  AddOutput(scene, &r->scenario);
  scene->footer(
      "Examples:\n  predictor export scene scenarios/box_9kg.yaml -o unity/box\n"
      "  predictor export scene scenarios/box_9kg.yaml --sdf -o gazebo/box\n");
}

void AddImport(CLI::App* app, Request* r) {
  ImportOptions* o = &r->imported;
  CLI::App* command =
      AddCommand(app, kToolGroup, "import",
                 "Import a recording of another system, so that `evaluate` can judge the person", r,
                 [o] { return ImportCommand(*o); });
  command->add_option("file", o->file, "Table (CSV), markers (TRC, C3D) or ROS 2 bag (MCAP, db3)")
      ->required();
  AddOption(command, "Input", "--map", &o->map, "MAP.yaml",
            "Mapping (YAML) that names the channels of the handles' poses and the hands' forces")
      ->required();
  AddOption(command, "Output", "-o,--output", &o->output, "FILE.person.csv",
            "File to write [default: NAME.person.csv]");
  AddOutput(command, o);
  command->footer("Example:\n  predictor import lift.mcap --map lift.yaml -o lift.person.csv\n");
}

// Adds a command that writes a changed copy of a recording to a new file.
CLI::App* AddCopy(CLI::App* app, const char* name, const char* what, const char* output, Request* r,
                  int (*command)(const RecordingOptions&)) {
  RecordingOptions* o = &r->recording;
  CLI::App* copy = AddCommand(app, kToolGroup, name, what, r, [o, command] { return command(*o); });
  AddRecording(copy, &o->recording);
  AddOption(copy, "Output", "-o,--output", &o->output, "FILE.mcap", output);
  AddOutput(copy, o);
  return copy;
}

void AddRepair(CLI::App* app, Request* r) {
  AddCopy(app, "repair", "Repair a truncated or damaged recording",
          "File to write [default: NAME.repaired.mcap]", r, RepairCommand)
      ->footer("Example:\n  predictor repair runs/cut.mcap\n");
}

void AddShare(CLI::App* app, Request* r) {
  AddCopy(app, "share", "Copy a recording without the person's body, stance and labels",
          "File to write [default: NAME.shared.mcap]", r, ShareCommand)
      ->footer("Example:\n  predictor share runs/p07_real.mcap -o shared/07.mcap\n");
}

void AddForget(CLI::App* app, Request* r) {
  ForgetOptions* o = &r->forget;
  CLI::App* forget =
      AddCommand(app, kToolGroup, "forget", "Delete all data of one person in a folder", r,
                 [o] { return ForgetCommand(*o); });
  forget->add_option("pseudonym", o->pseudonym, "Pseudonym of the person")->required();
  forget->add_option("folder", o->folder, "Folder to search, with all folders in it")->required();
  forget->add_flag("--yes", o->yes, "Delete without asking")->group("Output");
  AddJson(forget, o);
  AddQuiet(forget, o);
  forget->footer(
      "The command lists the files before it deletes them, and searches the folder again "
      "afterwards.\n\n"
      "Exit code 1: data remain, or a place could not be searched.\n\n"
      "Example:\n  predictor forget K7QM2XPX runs\n");
}

// Adds a command that prints a text.
CLI::App* AddPrint(CLI::App* app, const char* group, const char* name, const char* what, Request* r,
                   std::function<std::string()> text) {
  return AddCommand(app, group, name, what, r, [text = std::move(text)] {
    WriteOut(text());
    return kFinished;
  });
}

// Adds a command that prints one line or writes it as the JSON value `key`.
CLI::App* AddLine(CLI::App* app, const char* name, const char* what, const char* key, Request* r,
                  std::function<std::string()> line) {
  CLI::App* command = AddCommand(app, kToolGroup, name, what, r, [=, line = std::move(line)] {
    r->printed.CheckWritable();
    const std::string text = line();
    if (r->printed.json != "-") WriteOut(text + "\n");
    r->printed.WriteJson(nlohmann::json{{key, text}}.dump(2) + "\n");
    return kFinished;
  });
  AddJson(command, &r->printed);
  AddForce(command, &r->printed);
  return command;
}

void AddSchema(CLI::App* app, Request* r) {
  CLI::App* schema =
      app->add_subcommand("schema", "Print the JSON Schema of a file format, for editors")
          ->group(kToolGroup)
          ->require_subcommand(1);
  AddPrint(schema, "Commands", "scenario", "Schema of scenario files", r, ScenarioSchema);
  AddPrint(schema, "Commands", "machine", "Schema of machine files", r, MachineSchema);
  AddPrint(schema, "Commands", "check", "Schema of the report of a check (--json)", r, CheckSchema);
  AddPrint(schema, "Commands", "summary", "Schema of the summary of a run (--json)", r,
           SummarySchema);
  AddPrint(schema, "Commands", "evaluation", "Schema of the evaluation of a person (--json)", r,
           assessment::AssessmentSchema);
  AddPrint(schema, "Commands", "lifting-job",
           "Schema of the lifts of several recordings (evaluate --json)", r,
           assessment::LiftingJobSchema);
  AddPrint(schema, "Commands", "continuation", "Schema of the continuation of a run (--json)", r,
           ContinuationSchema);
  AddPrint(schema, "Commands", "population", "Schema of a population study (--json)", r,
           population::PopulationSchema);
}

void AddReference(CLI::App* app, Request* r) {
  CLI::App* reference =
      app->add_subcommand("reference", "Print a table of the reference as JSON, for documentation")
          ->group(kToolGroup)
          ->require_subcommand(1);
  AddPrint(reference, "Commands", "quantities",
           "Names, types, units, frames and meanings of all numbers in a recording", r,
           QuantitiesReference);
  AddPrint(reference, "Commands", "console", "Commands and keys of the console", r,
           ConsoleReference);
}

// Prints the help of the command that `words` name.
int ShowHelp(const CLI::App* app, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> commands = CommandsOf(*app);
    const auto found = std::ranges::find(commands, word, &CLI::App::get_name);
    if (found == commands.end()) {
      TheScreen().Print(UnknownCommand(*app, word));
      return kBadInput;
    }
    app = *found;
  }
  // CLI11's App::help would print the help of the command that was parsed, which is `help` itself.
  WriteOut(app->get_formatter()->make_help(app, "", CLI::AppFormatMode::Normal));
  return kFinished;
}

}  // namespace

void AddToolCommands(CLI::App* app, Request* r) {
  AddExport(app, r);
  AddImport(app, r);
  AddRepair(app, r);
  AddShare(app, r);
  AddForget(app, r);
  AddLine(app, "pseudonym", "Draw a new pseudonym for a person in a study", "pseudonym", r,
          DrawPseudonym)
      ->footer("Example:\n  predictor pseudonym\n");
  AddSchema(app, r);
  AddReference(app, r);
  CLI::App* help = AddCommand(app, kToolGroup, "help", "Show the help of a command", r,
                              [app, r] { return ShowHelp(app, r->help); });
  help->add_option("command", r->help,
                   "Command, for example survey report [default: list of all commands]");
  AddLine(app, "version", "Show version, commit, recording format and physics engines", "version",
          r, VersionText);
  AddPrint(app, kToolGroup, "man", "Print the manual page: predictor man | man -l -", r,
           [app] { return ManPage(*app); });
  CLI::App* completion =
      app->add_subcommand("completion", "Print a script that completes commands in a shell")
          ->group(kToolGroup)
          ->require_subcommand(1);
  AddPrint(completion, "Commands", "bash", "For bash: source <(predictor completion bash)", r,
           [app] { return BashCompletion(*app); });
}

}  // namespace predictor
