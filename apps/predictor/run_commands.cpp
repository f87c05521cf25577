// The commands that run a scenario or show a recorded run.
#include "command_line.h"
#include "scenario/participant.h"

namespace predictor {
namespace {

constexpr const char* kRunGroup = "Run";

void AddRunTime(CLI::App* app, ScenarioOptions* o) {
  AddOption(app, "Scenario", "--seed", &o->seed, "NUMBER",
            "Seed of all random draws [default: the scenario's]");
  AddOption(app, "Scenario", "--duration", &o->duration, "SECONDS",
            "Duration of the run [default: the scenario's]");
}

void AddRecordOptions(CLI::App* app, RecordOptions* o, const char* what) {
  AddOption(app, "Recording", "--record", &o->file, "FILE.mcap", what);
  AddRepeatable(app, "Recording", "--label", &o->labels, "KEY=VALUE",
                "Store a label in the recording (repeatable)");
  AddOption(app, "Person", "--participant", &o->participant, "FILE",
            "The person in a study: pseudonym, consent, handedness, body");
}

// Uses the body of the participant unless --set gives another body.
void TakeBody(const RecordOptions& record, ScenarioOptions* scenario) {
  if (record.participant.empty()) return;
  const ParticipantFile participant = LoadParticipant(record.participant);
  if (participant.body)
    scenario->set.insert(scenario->set.begin(), BodyOverride(*participant.body));
}

void AddRosOptions(CLI::App* app, ServeOptions* o) {
  const char* group = "Unity";
  CLI::Option* ros =
      app->add_flag("--ros-tcp", o->ros_tcp, "Serve Unity's ROS-TCP-Connector")->group(group);
  AddPort(app, group, "--ros-tcp-port", &o->ros.port, "Port of ROS-TCP (0: any)")->needs(ros);
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
  AddOption(app, group, "--ros-tcp-allow", &o->ros.allow, "NETWORK",
            "Also accept clients of this network, for example 192.0.2.0/24 (not encrypted)")
      ->needs(ros);
}

void AddEvaluation(CLI::App* app, ServeOptions* o) {
  app->add_flag("--evaluation,!--no-evaluation", o->evaluation,
                "Judge the person live [default: on, if the scenario specifies the operator's body "
                "and stance]")
      ->group("Person");
}

void AddStreams(CLI::App* app, lab_streams::StreamOptions* o) {
  AddRepeatable(
      app, "Person", "--person-stream", &o->streams, "NAME|MAP",
      "Measure the person with this stream of the Lab Streaming Layer: its name, or a mapping "
      "(.yaml) that names it (repeatable)");
  AddOption(app, "Person", "--lsl-library", &o->library, "FILE",
            "The library of the Lab Streaming Layer, liblsl.so [default: that of the system]");
}

void AddRun(CLI::App* app, Request* r) {
  CLI::App* run = AddCommand(app, kRunGroup, "run", "Run a scenario in real time", r, [r] {
    TakeBody(r->record, &r->scenario);
    return RunCommand(r->scenario, r->serve, r->record);
  });
  AddScenario(run, &r->scenario);
  AddRunTime(run, &r->scenario);
  AddOption(run, "Scenario", "--machine", &r->scenario.machine, "FILE",
            "Run on the real arms and sensors of this machine file");
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
  AddEvaluation(run, &r->serve);
  AddStreams(run, &r->serve.streams);
  AddRosOptions(run, &r->serve);
  AddOutput(run, &r->scenario);
  run->footer(
      "Examples:\n"
      "  predictor run scenarios/box_9kg.yaml\n"
      "  predictor run scenarios/by_hand.yaml --port 9000 --no-record\n"
      "  predictor run scenarios/dual_ur5.yaml --machine rig.yaml\n");
}

void AddSimulate(CLI::App* app, Request* r) {
  CLI::App* simulate = AddCommand(app, kRunGroup, "simulate",
                                  "Run a scenario in virtual time and print its summary", r, [r] {
                                    TakeBody(r->record, &r->scenario);
                                    return SimulateCommand(r->scenario, r->record);
                                  });
  AddScenario(simulate, &r->scenario);
  AddRunTime(simulate, &r->scenario);
  AddRecordOptions(simulate, &r->record, "Record to this file [default: no recording]");
  AddOutput(simulate, &r->scenario);
  simulate->footer(
      "Examples:\n"
      "  predictor simulate scenarios/box_9kg.yaml\n"
      "  predictor simulate scenarios/push.yaml --set safety.force=40 --json push.json\n");
}

void AddReplay(CLI::App* app, Request* r) {
  CLI::App* replay = AddCommand(app, kRunGroup, "replay",
                                "Show a recording in the browser, with seek, speed and step", r,
                                [r] { return ReplayCommand(r->recording, r->serve); });
  AddRecording(replay, &r->recording.recording);
  AddPageOptions(replay, &r->serve);
  AddEvaluation(replay, &r->serve);
  AddJson(replay, &r->recording);
  AddForce(replay, &r->recording);
  replay->footer("Example:\n  predictor replay runs/box_9kg_2026-01-31_14-05-09.mcap\n");
}

void AddInit(CLI::App* app, Request* r) {
  InitOptions* o = &r->init;
  CLI::App* init = AddCommand(app, kRunGroup, "init", "Write a commented scenario to start from", r,
                              [o] { return InitCommand(*o); });
  init->add_option("name", o->name, "Name of the scenario; NAME.yaml is written")->required();
  AddOption(init, "Scenario", "--arms", &o->arms, "1|2", "Number of haptic arms")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  AddOption(init, "Scenario", "--urdf", &o->urdf, "FILE",
            "URDF of your cobot [default: a Franka Panda]");
  AddOption(init, "Scenario", "--end-effector", &o->end_effector, "LINK",
            "Link of your cobot that holds the object [default: at the end of its longest arm, "
            "before the gripper's joints]");
  AddOption(init, "Scenario", "--object", &o->object, "box|bar|ball", "Object that the cobot holds")
      ->check(CLI::IsMember({"box", "bar", "ball"}))
      ->capture_default_str();
  AddOutput(init, o);
  init->footer(
      "Examples:\n"
      "  predictor init first && predictor run first.yaml\n"
      "  predictor init mine --arms 1 --urdf robot.urdf --object bar\n"
      "  export PREDICTOR_PACKAGE_PATH=$HOME/urdf  # a URDF in another folder\n"
      "  predictor init mine --urdf $HOME/urdf/robot.urdf\n"
      "A scenario may read a URDF from its own folder, from the folder assets beside this folder, "
      "and from the folders in PREDICTOR_PACKAGE_PATH.\n"
      "From a robot with grippers, several arms or wheels, the scenario uses only one arm, without "
      "its gripper's joints. The scenario lists the links that it leaves out.\n"
      "Exit code 1: no scenario with this cobot passed its check. The command writes the file "
      "nevertheless.\n");
}

}  // namespace

void AddRunCommands(CLI::App* app, Request* r) {
  AddRun(app, r);
  AddSimulate(app, r);
  AddReplay(app, r);
  AddInit(app, r);
}

}  // namespace predictor
