// A machine: the real arms and sensors of one laboratory, how they are reached, what is known of
// them, and the hardest limits there. A file of its own, apart from scenarios, which come and go.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenario/scenario.h"

namespace predictor {

enum class ArmMake { kUr, kFranka };
enum class SensorMake { kOwn, kNetFt, kOnRobot };  // kOwn: what the arm itself measures

// Of a Franka: what its own reflex stops it at.
struct CollisionThresholds {
  double force = 60;         // from outside, at the stiffness frame [N]
  double torque = 20;        // the same [N·m]
  double joint_torque = 40;  // from outside, of each joint [N·m]
};

// How an arm is reached.
struct ArmConnection {
  ArmMake make = ArmMake::kUr;
  std::string host;                              // address of its controller
  int first_register = 24;                       // UR: of the RTDE registers that we use, 0 or 24
  std::optional<CollisionThresholds> collision;  // Franka; none: as the robot has them
};

// How a force/torque sensor is reached.
struct SensorConnection {
  SensorMake make = SensorMake::kOwn;
  std::string host;
  double counts_per_force = 1e6;   // of its configuration [1/N]
  double counts_per_torque = 1e6;  // [1/(N·m)]
};

// What was measured at the arm itself.
struct Commissioned {
  std::string push_test;  // when a person pushed along each axis, and it read as pushed; "": never
  std::string of;         // HashOf the arm as it was then
  std::string loop;       // when `arm.loop` was measured; "": never
  std::string loop_of;    // HashOfLoop as it was then
};

// One arm with its sensor and handle.
struct MachineArm {
  ArmConnection connection;
  SensorConnection sensor;
  ArmSpec arm;  // as device.arms.* of a scenario, which it replaces
  std::optional<Commissioned> commissioned;
};

// What no scenario may loosen here. Names and units as in a scenario's `safety`; `least` where less
// is looser.
struct MachineLimits {
  double force = 30;                          // a hand [N]
  double torque = 5;                          // a hand [N·m]
  double handle_speed = 0.25;                 // [m/s]
  double handle_rotation_speed = 1.5;         // [rad/s]
  double stop_acceleration = 5;               // the least: less is a longer stop [m/s²]
  double stop_jerk = 250;                     // the least [m/s³]
  double align_speed = 0.05;                  // [m/s]
  double align_tolerance = 0.002;             // [m]
  double align_tolerance_rotation = 0.01745;  // [rad]
  double tracking = 0.05;                     // [m]
  double tracking_rotation = 0.35;            // [rad]
  double relative_slack = 0.002;              // [m/s]
  double relative_slack_rotation = 0.00873;   // [rad/s]
  double relative_slack_time = 0.050;         // [s]
  double coupling = 80;                       // [N]
  double coupling_torque = 15;                // [N·m]
  double max_age = 0.005;                     // [s]
  int frozen_samples = 50;
  // Of a scenario's `rendering`.
  double relative_kp = 1.0;        // [1/s]
  double relative_ko = 0.9;        // [1/s]
  double security_distance = 0.3;  // the least [m]
  double joint_security = 0.02;    // the least [rad]
};

// A device that a person holds pressed while the arms may move: its contact, at a digital input.
struct EnablingInput {
  std::string arm;        // left, right: whose controller it is wired to
  int digital_input = 0;  // UR: 0 … 7 standard, 8 … 15 configurable, 16, 17 the tool's
};

struct Machine {
  int predictor_machine = 1;  // version of the format
  std::string name;
  std::optional<MachineArm> left, right;
  MachineLimits limits;
  std::optional<EnablingInput> enabling;  // none: a key that is held at the console

  std::filesystem::path file;
  std::shared_ptr<const YamlNode> tree;  // as it was read, for the places of errors

  const std::optional<MachineArm>& arm(int hand) const { return hand == 0 ? left : right; }
};

// Reads and checks a machine file; errors as of LoadScenario. Models are named by package:// only.
Machine LoadMachine(const std::filesystem::path& file);
Machine ParseMachine(const std::string& text, const std::string& name);
// The whole machine as YAML, every default written out.
std::string SaveMachine(const Machine& machine);
// JSON Schema (draft-07) of machine files: every key with its unit, meaning, range and default.
std::string MachineSchema();

// `error` of a key of the machine ("arms.left.arm.elbow"), with its place in the file in front.
InputError Located(const InputError& error, const Machine& machine);

// Of all that is said of an arm but `commissioned`, whatever the order or comments: 16 hexadecimal
// digits (FNV-1a). Against forgetting, not against malice.
std::string HashOf(const MachineArm& arm);
// The arm is as it was when its pushes were tested.
bool IsPushTested(const MachineArm& arm);
// Of what a measured velocity loop is of: it, and the arm that it was measured at.
std::string HashOfLoop(const MachineArm& arm);
// `arm.loop` is what was measured, at this arm, and not a guess.
bool IsLoopMeasured(const MachineArm& arm);
// Which of the arms of `scenario` have a velocity loop that nobody measured, and what to do, a line
// each: ApplyMachine takes their lead away, which would be a guess.
std::vector<std::string> UnmeasuredLoops(const Machine& machine, const Scenario& scenario);
// Which of the arms of `scenario` are not push-tested as they are now, and what to do, a line each.
std::vector<std::string> UntestedPushes(const Machine& machine, const Scenario& scenario);
// Throws InputError with the first of these, if any.
void RequirePushTests(const Machine& machine, const Scenario& scenario);

// Puts the machine's arms in the place of the scenario's. A scenario may tighten the machine's
// limits, never loosen them, and its stop keeps the budget of real arms (90 ms, 13.5 mm out of 0.25
// m/s): throws InputError that names the key, as for a handle without an arm. Where a loop was not
// measured, the reference has no lead.
void ApplyMachine(const Machine& machine, Scenario* scenario);

}  // namespace predictor
