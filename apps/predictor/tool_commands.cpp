// The commands that convert, print and describe.
#include <algorithm>

#include "command_line.h"
#include "screen.h"

namespace predictor {
namespace {

constexpr const char* kGroup = "Tools";

void AddRecording(CLI::App* app, Request* r) {
  app->add_option("recording", r->recording.recording, "Recording (MCAP)")->required();
}

void AddTable(CLI::App* app, Request* r) {
  app->add_option("-o,--output", r->recording.output, "File to write [default: standard output]")
      ->type_name("FILE.csv")
      ->group("Output");
  AddForce(app, &r->recording);
  AddQuiet(app, &r->recording);
}

void AddExport(CLI::App* app, Request* r) {
  CLI::App* all = app->add_subcommand("export", "Export recordings as CSV, or the scene as URDF")
                      ->group(kGroup)
                      ->require_subcommand(1);
  CLI::App* data = all->add_subcommand("data", "Channels of a recording as CSV")->group("Commands");
  AddRecording(data, r);
  data->add_option("channels", r->recording.channels,
                   "Names of channels or groups; * matches anything [default: all]");
  data->add_option("--every", r->recording.every, "Number of ticks per row")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("TICKS")
      ->capture_default_str();
  AddTable(data, r);
  data->footer("Example:\n  predictor export data run.mcap cobot.q 'hands.*.wrench' -o run.csv\n");
  data->callback([r] { r->command = [r] { return ExportDataCommand(r->recording); }; });

  CLI::App* events =
      all->add_subcommand("events", "Events of a recording as CSV: tick, time, kind, text")
          ->group("Commands");
  AddRecording(events, r);
  AddTable(events, r);
  events->footer("Example:\n  predictor export events run.mcap -o events.csv\n");
  events->callback([r] { r->command = [r] { return ExportEventsCommand(r->recording); }; });

  CLI::App* channels =
      all->add_subcommand("channels", "Names and units of the channels")->group("Commands");
  AddRecording(channels, r);
  AddOutput(channels, &r->recording);
  channels->footer("Example:\n  predictor export channels run.mcap\n");
  channels->callback([r] { r->command = [r] { return ListChannelsCommand(r->recording); }; });

  CLI::App* scene =
      all->add_subcommand("scene", "The virtual scene as one URDF file with its meshes, for Unity")
          ->group("Commands");
  AddScenario(scene, &r->scenario);
  scene->add_option("-o,--output", r->scene.folder, "Folder to write [default: SCENARIO_scene]")
      ->type_name("FOLDER")
      ->group("Output");
  AddOutput(scene, &r->scenario);
  scene->footer("Example:\n  predictor export scene scenarios/box_9kg.yaml -o unity/box\n");
  scene->callback([r] { r->command = [r] { return ExportSceneCommand(r->scenario, r->scene); }; });
}

void AddRepair(CLI::App* app, Request* r) {
  CLI::App* repair =
      app->add_subcommand("repair", "Repair a truncated or damaged recording")->group(kGroup);
  AddRecording(repair, r);
  repair
      ->add_option("-o,--output", r->recording.output,
                   "File to write [default: NAME.repaired.mcap]")
      ->type_name("FILE.mcap")
      ->group("Output");
  AddOutput(repair, &r->recording);
  repair->footer("Example:\n  predictor repair runs/cut.mcap\n");
  repair->callback([r] { r->command = [r] { return RepairCommand(r->recording); }; });
}

void AddSchema(CLI::App* app, Request* r) {
  CLI::App* schema =
      app->add_subcommand("schema", "Print the JSON Schema of a file format, for editors")
          ->group(kGroup)
          ->require_subcommand(1);
  schema->add_subcommand("scenario", "Schema of scenario files")->group("Commands")->callback([r] {
    r->command = [] { return ScenarioSchemaCommand(); };
  });
  schema->add_subcommand("machine", "Schema of machine files")->group("Commands")->callback([r] {
    r->command = [] { return MachineSchemaCommand(); };
  });
  schema->add_subcommand("summary", "Schema of the summary of a run (--json)")
      ->group("Commands")
      ->callback([r] { r->command = [] { return SummarySchemaCommand(); }; });
}

// Prints the help of the command that `words` name.
int ShowHelp(const CLI::App* app, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> commands = CommandsOf(*app);
    const auto found = std::ranges::find(commands, word, &CLI::App::get_name);
    if (found == commands.end()) {
      TheScreen().Tell(UnknownCommand(*app, word));
      return kBadInput;
    }
    app = *found;
  }
  WriteOut(app->help());
  return kFinished;
}

}  // namespace

void AddToolCommands(CLI::App* app, Request* r) {
  AddExport(app, r);
  AddRepair(app, r);
  AddSchema(app, r);
  CLI::App* help = app->add_subcommand("help", "Show the help of a command")->group(kGroup);
  help->add_option("command", r->help, "Command, for example survey report");
  help->callback([app, r] { r->command = [app, r] { return ShowHelp(app, r->help); }; });
  const auto print = [app, r](const char* name, const char* group, std::string (*text)(CLI::App*)) {
    return app->add_subcommand(name, "")->group(group)->callback([app, r, text] {
      r->command = [app, text] {
        WriteOut(text(app));
        return kFinished;
      };
    });
  };
  print("version", kGroup, [](CLI::App*) {
    return VersionText() + "\n";
  })->description("Show version, commit and recording format");
  print("man", kGroup, [](CLI::App* all) {
    return ManPage(*all);
  })->description("Print the manual page: predictor man | man -l -");
  app->add_subcommand("completion", "Print a script that completes commands in a shell")
      ->group(kGroup)
      ->require_subcommand(1)
      ->add_subcommand("bash", "For bash: source <(predictor completion bash)")
      ->group("Commands")
      ->callback([app, r] {
        r->command = [app] {
          WriteOut(BashCompletion(*app));
          return kFinished;
        };
      });
}

}  // namespace predictor
