#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <string>

#include "commands.h"
#include "core/error.h"
#include "watchdog/watchdog_process.h"

namespace predictor {
namespace {

using Command = std::function<int()>;

void AddScenario(CLI::App* app, ScenarioOptions* o) {
  app->add_option("scenario", o->file, "Scenario file (YAML)")->required();
  app->add_option("--set", o->set,
                  "Override a value of the scenario: path.to.key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
}

void AddScenarioOptions(CLI::App* app, ScenarioOptions* o) {
  AddScenario(app, o);
  app->add_option("--seed", o->seed, "Seed of all random draws, instead of the scenario's")
      ->type_name("NUMBER");
  app->add_option("--duration", o->duration, "Seconds to run, instead of the scenario's")
      ->type_name("NUMBER");
  app->add_option("--summary", o->summary,
                  "Write the summary as JSON to this file; - for standard output");
  app->add_flag("--quiet", o->quiet, "No progress and no table");
}

// What the command line asks for.
struct Request {
  ScenarioOptions scenario;
  ServeOptions serve;
  RecordOptions record;
  ExportDataOptions data;
  bool verify = false;
  bool schema_of_machine = false;
  ExportOptions scene;
  IdentifyCommandOptions identify;
  ReportOptions report;
  CompareOptions compare;
  ReproduceCommandOptions reproduce;
  SurveyOptions survey;
  DevicesOptions devices;
  CalibrateOptions calibrate;
  std::vector<double> tip;
  bool no_search = false;
  std::string map;
  Command command;
};

CLI::Option* AddPort(CLI::App* app, const char* name, std::uint16_t* port, const char* what) {
  return app->add_option(name, *port, what)->check(CLI::Range(0, 65535))->type_name("NUMBER");
}

// As browsers tell it: scheme and host, perhaps a port, and nothing behind.
std::string NoOrigin(const std::string& text) {
  const std::size_t scheme = text.find("://");
  const bool web = text.starts_with("http://") || text.starts_with("https://");
  if (web && scheme + 3 < text.size() &&
      text.find_first_of("/?#@ ", scheme + 3) == std::string::npos)
    return "";
  return "'" + text + "' is no origin: give scheme and host, as https://app.foxglove.dev";
}

void AddPageOptions(CLI::App* app, ServeOptions* o) {
  AddPort(app, "--port", &o->page.port, "Port of the page (0: any)");
  app->add_option("--address", o->page.address,
                  "Address on which the page is served: 127.0.0.1, or 0.0.0.0 with --expose")
      ->type_name("ADDRESS");
  CLI::Option* expose = app->add_flag("--expose", o->page.expose,
                                      "Let other machines reach the page, by TLS and a code");
  CLI::Option* certificate =
      app->add_option("--certificate", o->page.certificate, "Your own certificate (PEM)")
          ->needs(expose);
  certificate->needs(
      app->add_option("--key", o->page.key, "The certificate's key (PEM)")->needs(certificate));
  app->add_option("--name", o->page.names, "Another name by which this machine is reached");
  app->add_option("--foxglove-origin", o->page.foxglove_origins,
                  "Page that may connect as Foxglove, as https://app.foxglove.dev")
      ->check(CLI::Validator(NoOrigin, "ORIGIN"))
      ->type_name("");
}

void AddServeOptions(CLI::App* app, ServeOptions* o) {
  app->add_option("--viewer", o->viewer, "Page in the browser: on (as a rule) or off")
      ->type_name("on|off");
  app->add_flag("--stay", o->stay,
                "Once at rest, stay until asked to end (as a rule at a terminal only)");
  AddPageOptions(app, o);
  CLI::Option* ros =
      app->add_flag("--ros-tcp", o->ros_tcp, "Serve Unity's ROS-TCP-Connector (docs/unity.md)");
  AddPort(app, "--ros-tcp-port", &o->ros.port, "Its port (0: any)")->needs(ros);
  app->add_option("--ros-tcp-mode", o->ros.dialect, "ros1 (as a rule) or ros2")
      ->transform(CLI::CheckedTransformer(std::map<std::string, RosDialect>{
          {"ros1", RosDialect::kRos1}, {"ros2", RosDialect::kRos2}}))
      ->needs(ros)
      ->type_name("ros1|ros2");
  app->add_option("--ros-tcp-allow", o->ros.allow,
                  "Network that may connect beside this machine, as 192.0.2.0/24; not encrypted")
      ->needs(ros)
      ->type_name("NETWORK");
}

void AddSurvey(CLI::App* app, Request* r) {
  CLI::App* survey = app->add_subcommand(
      "survey", "Questionnaire after a run, its report, and the removal of an answer");
  SurveyOptions* o = &r->survey;
  survey->add_option("places", o->places,
                     "The run's recording; for --report and --remove, answers or folders with them "
                     "(as a rule runs)");
  survey
      ->add_option("--condition", o->condition, "What was used, instead of what the recording says")
      ->type_name("real|emulated");
  AddPort(survey, "--port", &o->port, "Port of the page (0: any)");
  CLI::Option* report =
      survey->add_flag("--report", o->report, "Table, comparison and plot of all answers");
  survey->add_option("-o,--output", o->output, "The report's page, instead of survey.html")
      ->type_name("FILE")
      ->needs(report);
  CLI::Option* remove = survey->add_option("--remove", o->remove, "Remove what one person answered")
                            ->type_name("PSEUDONYM")
                            ->excludes(report);
  survey->add_flag("--paper", o->paper, "List the answers that lie behind the paper's Table 1")
      ->excludes(report)
      ->excludes(remove);
  survey->callback([r] { r->command = [r] { return SurveyCommand(r->survey); }; });
}

void AddReport(CLI::App* app, Request* r) {
  CLI::App* report = app->add_subcommand(
      "report", "One page about a recording, to look at and to print; of several, side by side");
  ReportOptions* o = &r->report;
  report->add_option("recordings", o->recordings, "Recordings (MCAP)")->required();
  report
      ->add_option("-o,--output", o->output, "The page, instead of the recording's name with .html")
      ->type_name("FILE.html");
  report->add_option("--svg", o->svg, "Write the plots as SVG files there as well")
      ->type_name("FOLDER");
  report->add_flag("--quiet", o->quiet, "No progress");
  report->callback([r] { r->command = [r] { return ReportCommand(r->report); }; });
}

void AddCompare(CLI::App* app, Request* r) {
  CLI::App* compare = app->add_subcommand(
      "compare", "How alike two runs of one task are, axis by axis, and what of it would be felt");
  CompareOptions* o = &r->compare;
  compare->add_option("recordings", o->a, "Recording (MCAP), as of the real robot, and its repeats")
      ->required();
  compare
      ->add_option("--with", o->b, "Recording to hold against it, as of the emulation; its repeats")
      ->required()
      ->type_name("RECORDING...");
  CLI::Option* phase = compare->add_flag("--by-phase", o->by_phase,
                                         "Lay cycles over one another (the path goes round)");
  compare->add_flag("--by-time", o->by_time, "From the start, second by second")->excludes(phase);
  compare->add_option("--summary", o->summary,
                      "Write the result as JSON to this file; - for standard output");
  compare->add_flag("--quiet", o->quiet, "No progress and no table");
  compare->callback([r] { r->command = [r] { return CompareCommand(r->compare); }; });
}

void AddReproduce(CLI::App* app, Request* r) {
  CLI::App* reproduce = app->add_subcommand(
      "reproduce", "The paper's experiments done again: a page with its figures beside ours");
  ReproduceCommandOptions* o = &r->reproduce;
  reproduce->add_option("-o,--output", o->folder, "Folder for the page, its figures and numbers")
      ->type_name("FOLDER")
      ->capture_default_str();
  reproduce->add_option("--scenarios", o->scenarios, "Folder of the project's scenarios")
      ->type_name("FOLDER")
      ->capture_default_str();
  reproduce->add_option("--only", o->only, "Only this experiment")->type_name("NAME");
  reproduce->add_flag("--quiet", o->quiet, "No progress and no table");
  reproduce->callback([r] { r->command = [r] { return ReproduceCommand(r->reproduce); }; });
}

void AddRecordOptions(CLI::App* app, RecordOptions* o) {
  app->add_option("--record", o->file, "Record the run to this file (MCAP)")
      ->type_name("FILE.mcap");
  app->add_option("--label", o->labels, "Written into the recording: key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
}

void AddRecordingCommands(CLI::App* app, Request* r) {
  CLI::App* replay =
      app->add_subcommand("replay", "Look at a recording in the browser, or compute it again");
  replay->add_option("recording", r->data.recording, "Recording (MCAP)")->required();
  replay->add_flag("--verify", r->verify,
                   "Compute the run again and tell at which tick, if any, it departs");
  replay->add_flag("--quiet", r->data.quiet, "No progress");
  AddPageOptions(replay, &r->serve);
  replay->callback([r] {
    r->command = [r] {
      return r->verify ? VerifyCommand(r->data.recording, r->data.quiet)
                       : ReplayCommand(r->data.recording, r->serve.page);
    };
  });

  CLI::App* recover =
      app->add_subcommand("recover", "Mend a recording that was cut or damaged: all that is whole");
  recover->add_option("recording", r->data.recording, "Recording (MCAP)")->required();
  recover
      ->add_option("-o,--output", r->data.output, "File to write, instead of NAME.recovered.mcap")
      ->type_name("FILE.mcap");
  recover->callback(
      [r] { r->command = [r] { return RecoverCommand(r->data.recording, r->data.output); }; });

  CLI::App* data = app->add_subcommand("export-data", "Channels of a recording as CSV");
  data->add_option("recording", r->data.recording, "Recording (MCAP)")->required();
  data->add_option("channels", r->data.channels,
                   "Names of channels or groups, * for anything (none: all)");
  data->add_option("-o,--output", r->data.output, "File to write, instead of standard output")
      ->type_name("FILE.csv");
  data->add_option("--every", r->data.every, "One row every so many ticks")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("TICKS");
  CLI::Option* list = data->add_flag("--list", r->data.list, "Only list the names of the channels");
  data->add_flag("--events", r->data.events, "The events instead: tick, time, kind, text")
      ->excludes(list);
  data->add_flag("--quiet", r->data.quiet, "No progress");
  data->callback([r] { r->command = [r] { return ExportDataCommand(r->data); }; });
}

void AddIdentify(CLI::App* app, Request* r) {
  CLI::App* identify =
      app->add_subcommand("identify", "Joint friction and load of the cobot, out of a recording");
  IdentifyCommandOptions* o = &r->identify;
  identify->add_option("recording", o->recording, "Recording (MCAP)")->required();
  identify
      ->add_option("--scenario", o->scenario,
                   "Scenario that says what cobot and load are believed to be, instead of the "
                   "recording's own")
      ->type_name("SCENARIO");
  identify->add_option("-o,--output", o->output, "Copy of the scenario, with the friction found")
      ->type_name("SCENARIO.yaml");
  identify->add_flag("--force", o->force, "Replace the file that --output names");
  identify->add_option("--summary", o->summary,
                       "Write the result as JSON to this file; - for standard output");
  identify
      ->add_option("--mass-uncertainty", o->mass_uncertainty,
                   "Standard deviation of a link's mass from its model, over the mass")
      ->check(CLI::Range(0.0, 1.0));
  identify
      ->add_option("--com-uncertainty", o->com_uncertainty,
                   "The same of a link's centre of mass, along each axis [m]")
      ->check(CLI::Range(0.0, 1.0));
  identify->add_flag("--quiet", o->quiet, "No progress and no table");
  identify->callback([r] { r->command = [r] { return IdentifyCommand(r->identify); }; });
}

// What `calibrate` measures, one step each.
struct CalibrateStep {
  const char *name, *what, *arm, *more;
};
constexpr CalibrateStep kCalibrateSteps[] = {
    {"handle", "Weigh the handle in six poses or more; this program moves nothing",
     "Which arm (needed where there are two)",
     "You lead the arm by its own free-drive, let go of everything and press Enter, pose by pose; "
     "each tilts the handle another way.\n"
     "Needs: the arm's address, a sensor that has warmed up, and roughly right base.rpy and "
     "sensor.pose.\n"
     "Writes: payload (mass and centre of mass).\n"
     "Example: predictor calibrate handle --machine rig.yaml --arm left"},
    {"bases",
     "Find where one arm stands in the other's frame, by points that both touch; this program "
     "moves nothing",
     "Whose base is written (as a rule right); the other arm's stays",
     "You lead both arms by their own free-drive and touch three marks or more (six are better) "
     "with the same tip, first all with the one arm, then all with the other, in the same order.\n"
     "Needs: both arms, marks that are not on a line, far apart and not all at one height, and "
     "where the tip's end is (--tip); without it you are asked whether the end-effector's origin "
     "touches.\n"
     "Writes: base.\n"
     "Example: predictor calibrate bases --machine rig.yaml --tip 0 0 0.18"},
    {"loop", "Measure how fast an arm follows: THE ARM MOVES",
     "Which arm (needed where there are two)",
     "While you hold s (or the enabling device), hands off the handle, one joint after the other "
     "swings by 30 mrad at most, for ten seconds; letting go stops. Joints that were measured are "
     "kept if it ends early, and the next time goes on with the others.\n"
     "Needs: the controller ready for commands, real-time scheduling on this computer and nothing "
     "else running on it, nobody within reach, a hand on the emergency stop.\n"
     "Writes: loop (bandwidth, damping ratio, delay), without which runs have no lead.\n"
     "Example: predictor calibrate loop --machine rig.yaml --arm left"},
    {"push", "Test that pushes on the handles read as they are; nothing moves",
     "Only this arm (as a rule all)",
     "You take your hands off, press Enter, then push each handle along +x, +y and +z of the world "
     "as you are told, with 5 to 25 N.\n"
     "Needs: base, sensor.pose and payload as they will stay: every later change asks for this "
     "test again.\n"
     "Writes: commissioned.push_test, without which `predictor run` moves no real arm.\n"
     "Example: predictor calibrate push --machine rig.yaml"}};

void AddCalibrateStep(CLI::App* calibrate, const CalibrateStep& step, Request* r) {
  CLI::App* app = calibrate->add_subcommand(step.name, step.what);
  CalibrateOptions* o = &r->calibrate;
  app->footer(step.more);
  app->add_option("--machine", o->machine, "Machine file; it is changed, a copy stays")
      ->type_name("FILE")
      ->required();
  app->add_option("--arm", o->arm, step.arm)
      ->type_name("left|right")
      ->check(CLI::IsMember({"left", "right"}));
  if (step.name == std::string("bases"))
    app->add_option("--tip", r->tip,
                    "x y z of the tip that touches, in each arm's end-effector [m]")
        ->expected(3);
  app->callback([r, step] {
    r->calibrate.what = step.name;
    if (r->tip.size() == 3) r->calibrate.tip = Vector3(r->tip.data());
    r->command = [r] { return CalibrateCommand(r->calibrate); };
  });
}

void AddRig(CLI::App* app, Request* r) {
  CLI::App* devices = app->add_subcommand(
      "devices", "Which of a machine's arms and sensors answer, and how well; nothing moves");
  devices->add_option("--machine", r->devices.machine, "Machine file (docs/commission-a-rig.md)")
      ->type_name("FILE")
      ->required();
  devices->add_option("--duration", r->devices.duration, "For which each is watched [s]")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  devices->callback([r] { r->command = [r] { return DevicesCommand(r->devices); }; });

  CLI::App* calibrate = app->add_subcommand(
      "calibrate", "Measure a real rig together with a person, and write it into its machine file");
  calibrate->require_subcommand(1);
  for (const CalibrateStep& step : kCalibrateSteps) AddCalibrateStep(calibrate, step, r);
  calibrate->footer(
      "`predictor calibrate STEP --help` tells each. Their order, and what to expect: "
      "docs/commission-a-rig.md.");
}

void AddCommands(CLI::App* app, Request* r) {
  CLI::App* run = app->add_subcommand("run", "Run a scenario in real time");
  AddScenarioOptions(run, &r->scenario);
  AddServeOptions(run, &r->serve);
  AddRecordOptions(run, &r->record);
  run->add_option("--machine", r->scenario.machine,
                  "Real arms and sensors: where they are, and the hardest limits (docs/machine.md)")
      ->type_name("FILE");
  run->add_flag("--no-record", r->record.off,
                "Record nothing (as a rule a run is recorded, in the folder runs)");
  for (const char* of_the_page :
       {"--expose", "--certificate", "--key", "--name", "--address", "--foxglove-origin", "--port"})
    run->get_option(of_the_page)->check([r](const std::string&) {
      return r->serve.viewer ? std::string() : "there is no page with --viewer off";
    });
  run->callback([r] { r->command = [r] { return RunCommand(r->scenario, r->serve, r->record); }; });

  CLI::App* simulate =
      app->add_subcommand("simulate", "Run a scenario in virtual time and print its summary");
  AddScenarioOptions(simulate, &r->scenario);
  AddRecordOptions(simulate, &r->record);
  simulate->callback([r] { r->command = [r] { return SimulateCommand(r->scenario, r->record); }; });

  AddRecordingCommands(app, r);
  AddIdentify(app, r);
  AddReport(app, r);
  AddCompare(app, r);
  AddReproduce(app, r);

  CLI::App* check = app->add_subcommand(
      "check", "What can be known before anything moves: models, reach, margins");
  AddScenarioOptions(check, &r->scenario);
  check
      ->add_option("--machine", r->scenario.machine,
                   "On these real arms: their places, loops and limits (docs/machine.md)")
      ->type_name("FILE");
  check->add_flag("--no-search", r->no_search, "Do not look for better places of the arms' bases");
  check
      ->add_option("--map", r->map,
                   "Also map how stiff a hand may be, predicted and simulated, into this folder "
                   "(minutes; goes on where an earlier run was cut)")
      ->type_name("FOLDER");
  check->callback(
      [r] { r->command = [r] { return CheckCommand(r->scenario, !r->no_search, r->map); }; });

  CLI::App* scene = app->add_subcommand(
      "export-scene", "Write the virtual scene as one URDF with its meshes, as for Unity");
  AddScenario(scene, &r->scenario);
  scene->add_option("-o,--output", r->scene.folder, "Folder to write, instead of SCENARIO_scene")
      ->type_name("FOLDER");
  scene->add_flag("--force", r->scene.force, "Replace what an earlier export wrote there");
  scene->add_flag("--quiet", r->scenario.quiet, "Print nothing but problems");
  scene->callback([r] { r->command = [r] { return ExportSceneCommand(r->scenario, r->scene); }; });

  AddSurvey(app, r);
  AddRig(app, r);

  CLI::App* schema =
      app->add_subcommand("schema", "Print the JSON Schema of scenarios, for editors");
  schema->add_flag("--machine", r->schema_of_machine, "That of machine files (docs/machine.md)");
  schema->callback([r] { r->command = [r] { return SchemaCommand(r->schema_of_machine); }; });
}

}  // namespace
}  // namespace predictor

int main(int argc, char** argv) {
  using namespace predictor;
  CLI::App app(
      "PREDICTOR: one or two robot arms as a physical emulator of physical human-robot "
      "collaboration.\n"
      "Exit codes: 0 finished, 1 ended in a stop by safety that nobody has reset (check: unfit), "
      "2 bad input or usage, 3 device or system failure.",
      "predictor");
  app.require_subcommand(1);
  app.set_version_flag("--version", PREDICTOR_VERSION);
  // Not a person's commands: what the run starts for its page, for Unity, and to watch over it.
  if (argc == 2 && std::string(argv[1]) == kViewerSubcommand) return ViewerMain();
  if (argc == 2 && std::string(argv[1]) == kRosTcpSubcommand) return RosTcpMain();
  if (argc == 2 && std::string(argv[1]) == kWatchdogSubcommand) return WatchdogMain();
  Request request;
  AddCommands(&app, &request);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (argc == 1) {
      std::fputs(app.help().c_str(), stderr);
      return kBadInput;
    }
    if (app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-') {
      std::fprintf(stderr, "predictor: there is no command '%s'. `predictor --help` lists them.\n",
                   argv[1]);
      return kBadInput;
    }
    const int code = app.exit(error);
    if (code != 0 && app.got_subcommand("calibrate") &&
        app.get_subcommand("calibrate")->get_subcommands().empty())
      std::fputs("The steps are handle, bases, loop and push, as `predictor calibrate loop ...`.\n",
                 stderr);
    return code == 0 ? kFinished : kBadInput;
  }
  try {
    return request.command();
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "predictor: %s\n", error.what());
    return kDeviceFailure;
  }
}
