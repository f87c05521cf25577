// A machine consists of the real arms and sensors of one laboratory, their connections, their
// properties, and the absolute limits that apply there. A machine has a separate file because
// scenarios change more often.
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
enum class SensorMake { kOwn, kNetFt, kOnRobot };  // kOwn: the arm's own sensor or estimator

// The thresholds of the collision reflex that the Franka arm itself has.
struct CollisionThresholds {
  double force = 60;         // external force at the stiffness frame [N]
  double torque = 20;        // external torque at the stiffness frame [N·m]
  double joint_torque = 40;  // external torque of each joint [N·m]
};

// Connection to an arm.
struct ArmConnection {
  ArmMake make = ArmMake::kUr;
  std::string host;                              // address of its controller
  int first_register = 24;                       // UR: the first RTDE register used, 0 or 24
  std::optional<CollisionThresholds> collision;  // Franka: empty for the robot's own settings
};

// The connection to a force/torque sensor.
struct SensorConnection {
  SensorMake make = SensorMake::kOwn;
  std::string host;
  double counts_per_force = 1e6;   // counts per newton, from the sensor's configuration [1/N]
  double counts_per_torque = 1e6;  // [1/(N·m)]
};

// The results of measurements at the real arm.
struct Commissioned {
  std::string push_test;  // time at which a person pushed along each axis and every push was read
                          // correctly; "": never
  std::string of;         // HashOf the arm at that time
  std::string loop;       // time at which `arm.loop` was measured; "": never
  std::string loop_of;    // value of HashOfLoop at that time
};

// One arm with its sensor and handle.
struct MachineArm {
  ArmConnection connection;
  SensorConnection sensor;
  ArmSpec arm;  // like device.arms.* of a scenario, which it replaces
  std::optional<Commissioned> commissioned;
};

// Limits that no scenario may loosen on this machine. The limits have the names and units of a
// scenario's `safety`. Some limits are minima. For a minimum, a smaller value is looser.
struct MachineLimits {
  double force = 30;                   // limit per hand [N]
  double torque = 5;                   // limit per hand [N·m]
  double handle_speed = 0.25;          // [m/s]
  double handle_rotation_speed = 1.5;  // [rad/s]
  double stop_acceleration = 5;        // minimum: a smaller value means a longer stop [m/s²]
  double stop_jerk = 250;              // minimum jerk [m/s³]
  double align_speed = 0.05;           // [m/s]
  double align_tolerance = 0.002;      // [m]
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
  // The limits for the values in a scenario's `rendering`.
  double relative_kp = 1.0;        // [1/s]
  double relative_ko = 0.9;        // [1/s]
  double security_distance = 0.3;  // minimum distance [m]
  double joint_security = 0.02;    // minimum distance [rad]
};

// A device that a person must keep pressed while the real arms may move. The device's contact is
// wired to a digital input.
struct EnablingInput {
  std::string arm;        // left, right: the controller to which it is wired
  int digital_input = 0;  // UR: 0 … 7 standard inputs, 8 … 15 configurable inputs, 16, 17 tool
                          // inputs
};

struct Machine {
  int predictor_machine = 1;  // version of the file format
  std::string name;
  std::optional<MachineArm> left, right;
  MachineLimits limits;
  std::optional<double> ground;           // height in R of the ground under the person [m]
  std::optional<EnablingInput> enabling;  // empty: a key held at the console is used instead

  std::filesystem::path file;
  std::shared_ptr<const YamlNode> tree;  // the tree from which it was read, for the places of
                                         // errors

  const std::optional<MachineArm>& arm(int hand) const { return hand == 0 ? left : right; }
};

// Reads and checks a machine file. Throws the same kinds of errors as LoadScenario. Paths of models
// must begin with package://.
Machine LoadMachine(const std::filesystem::path& file);
Machine ParseMachine(const std::string& text, const std::string& name);
// Returns the whole machine as YAML, including every default.
std::string SaveMachine(const Machine& machine);
// Returns the JSON Schema (draft-07) of machine files, with keys, units, meanings, ranges and
// defaults.
std::string MachineSchema();

// Returns `error`, which concerns a key such as "arms.left.arm.elbow", preceded by the key's place
// in the file.
InputError Located(const InputError& error, const Machine& machine);

// Returns a hash (FNV-1a, 16 hexadecimal digits) of the entry of an arm except `commissioned`. The
// order of the keys and the comments do not affect this hash. The hash protects against oversight,
// not against malice.
std::string HashOf(const MachineArm& arm);
// Returns whether the arm has not changed since its push test.
bool IsPushTested(const MachineArm& arm);
// Returns a hash of everything on which a measured velocity loop depends. These are the loop and
// the arm on which the loop was measured.
std::string HashOfLoop(const MachineArm& arm);
// Returns whether `arm.loop` was measured on this arm.
bool IsLoopMeasured(const MachineArm& arm);
// Returns one line with the remedy for each arm of `scenario` whose velocity loop was not measured.
// ApplyMachine removes the lead of the arms whose velocity loop was not measured, because the lead
// would be based on an assumed lag.
std::vector<std::string> UnmeasuredLoops(const Machine& machine, const Scenario& scenario);
// Returns one line with the remedy for each arm of `scenario` without a current push test.
std::vector<std::string> UntestedPushes(const Machine& machine, const Scenario& scenario);
// Throws InputError with the first line of UntestedPushes, if there is one.
void RequirePushTests(const Machine& machine, const Scenario& scenario);

// Replaces the arms of the scenario by those of the machine. A scenario may tighten the machine's
// limits but never loosen them. Its stop must take at most 90 ms and 13.5 mm from 0.25 m/s, as all
// stops of real arms. Throws InputError that names the key if the scenario does not fit, or if the
// machine lacks an arm for a handle. If the velocity loop of an arm was not measured, the lead is
// set to zero.
void ApplyMachine(const Machine& machine, Scenario* scenario);

}  // namespace predictor
