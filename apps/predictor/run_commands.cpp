// The commands that run a scenario or show a recorded run.
#include "command_line.h"

namespace predictor {
namespace {

constexpr const char* kGroup = "Run";

void AddRunTime(CLI::App* app, ScenarioOptions* o) {
  app->add_option("--seed", o->seed, "Seed of all random draws [default: the scenario's]")
      ->type_name("NUMBER")
      ->group("Scenario");
  app->add_option("--duration", o->duration, "Duration of the run [default: the scenario's]")
      ->type_name("SECONDS")
      ->group("Scenario");
}

void AddRecordOptions(CLI::App* app, RecordOptions* o, const char* what) {
  app->add_option("--record", o->file, what)->type_name("FILE.mcap")->group("Recording");
  app->add_option("--label", o->labels, "Store a label in the recording (repeatable)")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group("Recording");
}

void AddRosOptions(CLI::App* app, ServeOptions* o) {
  const char* group = "Unity";
  CLI::Option* ros =
      app->add_flag("--ros-tcp", o->ros_tcp, "Serve Unity's ROS-TCP-Connector")->group(group);
  AddPort(app, "--ros-tcp-port", &o->ros.port, "Port of ROS-TCP (0: any)")
      ->needs(ros)
      ->group(group);
  app->add_option_function<std::string>(
         "--ros-tcp-mode",
         [o](const std::string& mode) {
           o->ros.dialect =
               mode == "ros2" ? ros_tcp::RosDialect::kRos2 : ros_tcp::RosDialect::kRos1;
         },
         "Dialect of the messages [default: ros1]")
      ->check(CLI::IsMember({"ros1", "ros2"}))
      ->needs(ros)
      ->type_name("ros1|ros2")
      ->group(group);
  app->add_option("--ros-tcp-allow", o->ros.allow,
                  "Also accept clients of this network, for example 192.0.2.0/24 (not encrypted)")
      ->needs(ros)
      ->type_name("NETWORK")
      ->group(group);
}

void AddRun(CLI::App* app, Request* r) {
  CLI::App* run = app->add_subcommand("run", "Run a scenario in real time")->group(kGroup);
  AddScenario(run, &r->scenario);
  AddRunTime(run, &r->scenario);
  run->add_option("--machine", r->scenario.machine,
                  "Run on the real arms and sensors of this machine file")
      ->type_name("FILE")
      ->group("Scenario");
  run->add_flag("--viewer,!--no-viewer", r->serve.viewer, "Serve the viewer page [default: on]")
      ->group("Viewer");
  AddPageOptions(run, &r->serve);
  for (const char* option :
       {"--expose", "--certificate", "--key", "--name", "--address", "--foxglove-origin", "--port"})
    run->get_option(option)->check([r](const std::string&) {
      return r->serve.viewer ? std::string() : "with --no-viewer, there is no page";
    });
  run->add_flag_function(
         "--stay,!--no-stay", [r](std::int64_t count) { r->serve.stay = count > 0; },
         "After the end, keep running until Ctrl-C [default: at a terminal, and while a page shows "
         "the results]")
      ->group("Viewer");
  AddRecordOptions(run, &r->record,
                   "Record to this file [default: a new file in runs/, about 90 MB per minute]");
  run->add_flag("--no-record", r->record.off, "Do not record")->group("Recording");
  AddRosOptions(run, &r->serve);
  AddOutput(run, &r->scenario);
  run->footer(
      "Examples:\n"
      "  predictor run scenarios/box_9kg.yaml\n"
      "  predictor run scenarios/by_hand.yaml --port 9000 --no-record\n"
      "  predictor run scenarios/dual_ur5.yaml --machine rig.yaml\n");
  run->callback([r] { r->command = [r] { return RunCommand(r->scenario, r->serve, r->record); }; });
}

void AddSimulate(CLI::App* app, Request* r) {
  CLI::App* simulate =
      app->add_subcommand("simulate", "Run a scenario in virtual time and print its summary")
          ->group(kGroup);
  AddScenario(simulate, &r->scenario);
  AddRunTime(simulate, &r->scenario);
  AddRecordOptions(simulate, &r->record, "Record to this file [default: no recording]");
  AddOutput(simulate, &r->scenario);
  simulate->footer(
      "Examples:\n"
      "  predictor simulate scenarios/box_9kg.yaml\n"
      "  predictor simulate scenarios/push.yaml --set safety.force=40 --json push.json\n");
  simulate->callback([r] { r->command = [r] { return SimulateCommand(r->scenario, r->record); }; });
}

void AddReplay(CLI::App* app, Request* r) {
  CLI::App* replay =
      app->add_subcommand("replay", "Show a recording in the browser, with seek, speed and step")
          ->group(kGroup);
  replay->add_option("recording", r->recording.recording, "Recording (MCAP)")->required();
  AddPageOptions(replay, &r->serve);
  replay->footer("Example:\n  predictor replay runs/box_9kg_2026-01-31_14-05-09.mcap\n");
  replay->callback(
      [r] { r->command = [r] { return ReplayCommand(r->recording.recording, r->serve.page); }; });
}

void AddInit(CLI::App* app, Request* r) {
  CLI::App* init =
      app->add_subcommand("init", "Write a commented scenario to start from")->group(kGroup);
  init->add_option("name", r->init.name, "Name of the scenario; NAME.yaml is written")->required();
  init->add_option("--arms", r->init.arms, "Number of haptic arms")
      ->type_name("1|2")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str()
      ->group("Scenario");
  init->add_option("--urdf", r->init.urdf, "URDF of your cobot [default: a Franka Panda]")
      ->type_name("FILE")
      ->group("Scenario");
  init->add_option("--end-effector", r->init.end_effector,
                   "Link of your cobot that holds the object [default: at the end of its longest "
                   "arm, before the gripper's joints]")
      ->type_name("LINK")
      ->group("Scenario");
  init->add_option("--object", r->init.object, "Object that the cobot holds")
      ->type_name("box|bar|ball")
      ->check(CLI::IsMember({"box", "bar", "ball"}))
      ->capture_default_str()
      ->group("Scenario");
  AddOutput(init, &r->init);
  init->footer(
      "Examples:\n"
      "  predictor init first && predictor run first.yaml\n"
      "  predictor init mine --arms 1 --urdf robot.urdf --object bar\n"
      "Of a robot with grippers, several arms or wheels, only one arm is used, without its "
      "gripper's "
      "joints; the scenario lists what is left out.\n"
      "Exit code 1: no scenario with this cobot passed its check; the file is written "
      "nevertheless.\n");
  init->callback([r] { r->command = [r] { return InitCommand(r->init); }; });
}

}  // namespace

void AddRunCommands(CLI::App* app, Request* r) {
  AddRun(app, r);
  AddSimulate(app, r);
  AddReplay(app, r);
  AddInit(app, r);
}

}  // namespace predictor
