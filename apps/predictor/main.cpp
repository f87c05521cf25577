#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <string>

#include "commands.h"
#include "core/error.h"

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
  ExportOptions scene;
  bool no_search = false;
  Command command;
};

void AddServeOptions(CLI::App* app, ServeOptions* o) {
  app->add_option("--viewer", o->viewer, "Page in the browser: on (as a rule) or off")
      ->type_name("on|off");
  app->add_flag("--stay", o->stay,
                "Once at rest, stay until asked to end (as a rule at a terminal only)");
  app->add_option("--port", o->page.port, "Port of the page (0: any)")->type_name("NUMBER");
  app->add_option("--address", o->page.address, "Address on which the page is served")
      ->type_name("ADDRESS");
  app->add_flag("--expose", o->page.expose, "Let other machines reach the page, by TLS and a code");
  app->add_option("--certificate", o->page.certificate, "Your own certificate (PEM)");
  app->add_option("--key", o->page.key, "The certificate's key (PEM)");
  app->add_option("--name", o->page.names, "Another name by which this machine is reached");
  app->add_option("--foxglove-origin", o->page.foxglove_origins,
                  "Page that may connect as Foxglove, as https://app.foxglove.dev");
  app->add_flag("--ros-tcp", o->ros_tcp, "Serve Unity's ROS-TCP-Connector (docs/unity.md)");
  app->add_option("--ros-tcp-port", o->ros.port, "Its port (0: any)")->type_name("NUMBER");
  app->add_option("--ros-tcp-mode", o->ros.dialect, "ros1 (as a rule) or ros2")
      ->transform(CLI::CheckedTransformer(std::map<std::string, RosDialect>{
          {"ros1", RosDialect::kRos1}, {"ros2", RosDialect::kRos2}}))
      ->type_name("ros1|ros2");
  app->add_option("--ros-tcp-allow", o->ros.allow,
                  "Network that may connect beside this machine, as 192.0.2.0/24; not encrypted")
      ->type_name("NETWORK");
}

void AddCommands(CLI::App* app, Request* r) {
  CLI::App* run = app->add_subcommand("run", "Run a scenario in real time");
  AddScenarioOptions(run, &r->scenario);
  AddServeOptions(run, &r->serve);
  run->callback([r] { r->command = [r] { return RunCommand(r->scenario, r->serve); }; });

  CLI::App* simulate =
      app->add_subcommand("simulate", "Run a scenario in virtual time and print its summary");
  AddScenarioOptions(simulate, &r->scenario);
  simulate->callback([r] { r->command = [r] { return SimulateCommand(r->scenario); }; });

  CLI::App* check = app->add_subcommand(
      "check", "What can be known before anything moves: models, reach, margins");
  AddScenarioOptions(check, &r->scenario);
  check->add_flag("--no-search", r->no_search, "Do not look for better places of the arms' bases");
  check->callback([r] { r->command = [r] { return CheckCommand(r->scenario, !r->no_search); }; });

  CLI::App* scene = app->add_subcommand(
      "export-scene", "Write the virtual scene as one URDF with its meshes, as for Unity");
  AddScenario(scene, &r->scenario);
  scene->add_option("-o,--output", r->scene.folder, "Folder to write, instead of SCENARIO_scene")
      ->type_name("FOLDER");
  scene->add_flag("--force", r->scene.force, "Replace what an earlier export wrote there");
  scene->add_flag("--quiet", r->scenario.quiet, "Print nothing but problems");
  scene->callback([r] { r->command = [r] { return ExportSceneCommand(r->scenario, r->scene); }; });

  CLI::App* schema =
      app->add_subcommand("schema", "Print the JSON Schema of scenarios, for editors");
  schema->callback([r] { r->command = [] { return SchemaCommand(); }; });
}

}  // namespace
}  // namespace predictor

int main(int argc, char** argv) {
  using namespace predictor;
  CLI::App app(
      "PREDICTOR: one or two robot arms as a physical emulator of physical human-robot "
      "collaboration.\n"
      "Exit codes: 0 finished, 1 stopped by safety (check: unfit), 2 bad input or usage, 3 device "
      "or system failure.",
      "predictor");
  app.require_subcommand(1);
  app.set_version_flag("--version", PREDICTOR_VERSION);
  // Not a person's command: what the run starts for its page.
  if (argc == 2 && std::string(argv[1]) == kViewerSubcommand) return ViewerMain();
  Request request;
  AddCommands(&app, &request);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-') {
      std::fprintf(stderr, "predictor: there is no command '%s'. `predictor --help` lists them.\n",
                   argv[1]);
      return kBadInput;
    }
    return app.exit(error) == 0 ? kFinished : kBadInput;
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
