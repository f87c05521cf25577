// The commands for real arms.
#include "command_line.h"

namespace predictor {
namespace {

// A step of `calibrate`.
struct CalibrateStep {
  const char *name, *what, *arm, *more;
};
constexpr CalibrateStep kCalibrateSteps[] = {
    {"handle", "Weigh the handle in six poses or more; this program does not move the arm",
     "Which arm (required if there are two)",
     "For each pose, guide the arm in its own free-drive mode, take your hands off and press "
     "Enter. Tilt the handle differently each time.\n"
     "Needs: the arm's address, a warm sensor, and approximate base.rpy and sensor.pose.\n"
     "Writes: payload (mass and centre of mass).\n"
     "Example:\n"
     "  predictor calibrate handle --machine rig.yaml --arm left"},
    {"bases",
     "Locate one arm relative to the other, by points that both touch; this program does not "
     "move the arms",
     "Arm whose base is written [default: right]",
     "Guide the arms in their own free-drive modes. Touch three or more marks (six are better) "
     "with the same tip: first all with one arm, then all with the other, in the same order.\n"
     "Needs: both arms; marks that are far apart, not on a line and not all at one height; and the "
     "position of the tip (--tip). Without --tip, the program asks whether the end-effector's "
     "origin touches the marks.\n"
     "Writes: base.\n"
     "Example:\n"
     "  predictor calibrate bases --machine rig.yaml --tip 0 0 0.18"},
    {"loop", "Measure how fast an arm follows: THE ARM MOVES",
     "Which arm (required if there are two)",
     "Keep your hands off the handle and hold s (or the enabling device). Each joint in turn "
     "oscillates by at most 30 mrad for ten seconds. Releasing the key or device stops the arm. "
     "The results of measured joints are kept. Run the command again to measure the other joints.\n"
     "Needs: the controller ready for commands, real-time scheduling on this computer and no other "
     "programs, no person within reach, and a hand on the emergency stop.\n"
     "Writes: loop (bandwidth, damping ratio, delay). Without these values, runs have no lag "
     "compensation.\n"
     "Example:\n"
     "  predictor calibrate loop --machine rig.yaml --arm left"},
    {"push", "Check the direction of the force readings by pushing the handles; nothing moves",
     "Only this arm [default: all]",
     "Take your hands off and press Enter. When the program prompts you, push each handle along "
     "+x, +y and +z of the world with 5 to 25 N.\n"
     "Needs: final values of base, sensor.pose and payload. Repeat this test after any later "
     "change.\n"
     "Writes: commissioned.push_test. Without this entry, `predictor run` does not move real "
     "arms.\n"
     "Example:\n"
     "  predictor calibrate push --machine rig.yaml"}};

void AddCalibrateStep(CLI::App* calibrate, const CalibrateStep& step, Request* r) {
  CalibrateOptions* o = &r->calibrate;
  CLI::App* app = AddCommand(calibrate, "Steps", step.name, step.what, r, [r, step] {
    r->calibrate.what = step.name;
    if (r->tip.size() == 3) r->calibrate.tip = Vector3(r->tip.data());
    return CalibrateCommand(r->calibrate);
  });
  app->footer(step.more);
  app->add_option("--machine", o->machine, "Machine file; the program changes it and keeps a copy")
      ->type_name("FILE")
      ->required();
  app->add_option("--arm", o->arm, step.arm)
      ->type_name("left|right")
      ->check(CLI::IsMember({"left", "right"}));
  if (step.name == std::string("bases"))
    app->add_option("--tip", r->tip, "Position of the tip in the end-effector frame, in metres")
        ->type_name("X Y Z")
        ->expected(3);
  AddJson(app, o);
  AddForce(app, o);
}

}  // namespace

void AddRigCommands(CLI::App* app, Request* r) {
  DevicesOptions* o = &r->devices;
  CLI::App* devices =
      AddCommand(app, "Rig", "devices",
                 "Check which arms and sensors respond, and at which rate; nothing moves", r,
                 [o] { return DevicesCommand(*o); });
  devices->add_option("--machine", o->machine, "Machine file")->type_name("FILE")->required();
  devices->add_option("--duration", o->duration, "Time for which each device is observed")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  AddOutput(devices, o);
  devices->footer("Example:\n  predictor devices --machine rig.yaml\n");

  CLI::App* calibrate =
      app->add_subcommand("calibrate",
                          "Measure a real rig with your help, and write its machine file")
          ->group("Rig");
  calibrate->require_subcommand(1);
  for (const CalibrateStep& step : kCalibrateSteps) AddCalibrateStep(calibrate, step, r);
  calibrate->footer("`predictor calibrate STEP --help` describes a step. Follow this order.");
}

}  // namespace predictor
