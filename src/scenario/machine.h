// A machine: the real arms and sensors of one laboratory, how they are reached, what is known of
// them, and the hardest limits there. A file of its own, apart from scenarios, which come and go.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

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

// That a person has pushed the handle along each axis, and it read as pushed.
struct Commissioned {
  std::string push_test;  // when: a date
  std::string of;         // HashOf the arm as it was then
};

// One arm with its sensor and handle.
struct MachineArm {
  ArmConnection connection;
  SensorConnection sensor;
  ArmSpec arm;  // as device.arms.* of a scenario, which it replaces
  std::optional<Commissioned> commissioned;
};

// What no scenario may exceed here. Names and units as in a scenario's `safety`.
struct MachineLimits {
  double force = 30;                   // a hand [N]
  double torque = 5;                   // a hand [N·m]
  double handle_speed = 0.25;          // [m/s]
  double handle_rotation_speed = 1.5;  // [rad/s]
  double stop_acceleration = 5;        // [m/s²]
  double stop_jerk = 250;              // [m/s³]
  double align_speed = 0.05;           // [m/s]
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

// Of all that is said of an arm but `commissioned`, whatever the order or comments: 16 hexadecimal
// digits (FNV-1a). Against forgetting, not against malice.
std::string HashOf(const MachineArm& arm);
// The arm is as it was when its pushes were tested.
bool IsPushTested(const MachineArm& arm);
// Throws InputError: an arm of a hand that `scenario` has is not push-tested as it is now.
void RequirePushTests(const Machine& machine, const Scenario& scenario);

// Puts the machine's arms in the place of the scenario's. A scenario may tighten the machine's
// limits, never loosen them: throws InputError that names the key, as for a handle without an arm.
void ApplyMachine(const Machine& machine, Scenario* scenario);

}  // namespace predictor
