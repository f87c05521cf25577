// Tests how the file of a machine is read, checked and written.
#include "scenario/machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <string>

#include "safety/stop.h"
#include "scenario/scenario_io.h"
#include "scenario/stop_budget.h"
#include "scenario/two_arm_machine.h"

namespace predictor {
namespace {

TEST(Machine, IsReadAndWritten) {
  const Machine machine = ParseMachine(kMachine, "lab.yaml");
  EXPECT_EQ(machine.left->connection.make, ArmMake::kUr);
  EXPECT_EQ(machine.left->connection.host, "192.0.2.10");
  EXPECT_EQ(machine.left->sensor.make, SensorMake::kNetFt);
  EXPECT_EQ(machine.left->arm.sample_rate, 500);
  EXPECT_EQ(machine.right->connection.make, ArmMake::kFranka);
  EXPECT_EQ(machine.limits.force, 25);
  EXPECT_EQ(machine.limits.torque, 5);
  const std::string text = SaveMachine(machine);
  EXPECT_EQ(SaveMachine(ParseMachine(text, "again.yaml")), text);
}

TEST(Machine, ReportsErrorsAndTheirPlaces) {
  EXPECT_NE(MachineRefusal(With(kMachine, "make: ur", "make: abb"))
                .find("lab.yaml:5:24: arms.left.connection.make"),
            std::string::npos)
      << MachineRefusal(With(kMachine, "make: ur", "make: abb"));
  EXPECT_NE(MachineRefusal(With(kMachine, ", host: 192.0.2.20", "")).find("sensor.host is missing"),
            std::string::npos);
  EXPECT_NE(MachineRefusal(With(kMachine, "make: net_ft, ", "")).find("has no separate address"),
            std::string::npos);
  EXPECT_NE(MachineRefusal(With(kMachine, "package://example-robot-data/robots/ur", "models/ur"))
                .find("package://"),
            std::string::npos);
  EXPECT_NE(MachineRefusal(With(kMachine, "handle_speed: 0.2", "handle_speed: 2")).find("0.5"),
            std::string::npos);
  EXPECT_NE(MachineRefusal(With(kMachine, "limits:", "limit:")).find("limits"), std::string::npos);
  EXPECT_NE(MachineRefusal("predictor_machine: 1\n").find("needs at least one arm"),
            std::string::npos);
}

TEST(Machine, AnAddressInNumbersIsOne) {
  for (const char* host : {"300.1.1.1", "192.0.2", "192.0.2.10:30004", "192.0.2.10.1", "fe80::1"}) {
    const std::string quoted = "\"" + std::string(host) + "\"";
    const std::string arm = MachineRefusal(With(kMachine, "192.0.2.10", quoted));
    EXPECT_NE(arm.find("lab.yaml:5:34: arms.left.connection.host is " + quoted +
                       ", which is not an IPv4 address"),
              std::string::npos)
        << arm;
    const std::string sensor = MachineRefusal(With(kMachine, "192.0.2.20", quoted));
    EXPECT_NE(sensor.find("arms.left.sensor.host is " + quoted), std::string::npos) << sensor;
  }
  EXPECT_EQ(MachineRefusal(With(kMachine, "192.0.2.10", "ur-in-room-12")), "");
}

TEST(Machine, EachArmAndEachSensorHasItsOwnAddress) {
  EXPECT_EQ(MachineRefusal(With(kMachine, "192.0.2.11", "192.0.2.10")),
            "lab.yaml:13:38: arms.right.connection.host is also the address of the left arm. Give "
            "each arm its own address.");
  const auto sensor = [](const std::string& host) {
    return With(kMachine, "host: 192.0.2.11}\n",
                "host: 192.0.2.11}\n    sensor: {make: net_ft, host: " + host + "}\n");
  };
  EXPECT_EQ(MachineRefusal(sensor("192.0.2.20")),
            "lab.yaml:14:34: arms.right.sensor.host is also the address of the left sensor, but "
            "one sensor cannot measure both hands. Give each sensor its own address.");
  EXPECT_EQ(MachineRefusal(sensor("192.0.2.21")), "");
  // A sensor that is a part of an arm has no separate address.
  EXPECT_EQ(MachineRefusal(With(kMachine, "    sensor: {make: net_ft, host: 192.0.2.20}\n", "")),
            "");
}

TEST(Machine, AMisspeltGroupIsReportedOnce) {
  EXPECT_EQ(MachineRefusal(With(kMachine, "connection:", "conection:")),
            "lab.yaml:5:5: \"conection\" is not a key of arms.left. Did you mean connection?");
  EXPECT_EQ(MachineRefusal(With(kMachine, "arms:", "arm:")),
            "lab.yaml:3:1: \"arm\" is not a key. Did you mean arms?");
  // If a word resembles no key, the message must not suggest a key.
  EXPECT_NE(
      MachineRefusal(With(kMachine, "connection:", "wire:")).find("connection.make is missing"),
      std::string::npos);
}

// Compares the limits with the table of docs/reference/machine-file.md.
TEST(Machine, MayHaveTheLimitsThatItsDocumentSays) {
  std::ifstream document(PREDICTOR_SOURCE_DIR "/docs/reference/machine-file.md");
  const std::regex row(R"(\| `(\w+)` \| ([0-9.]+) \| (above )?([0-9.]+),? to ([0-9.]+) \|.*)");
  const std::string defaults =
      SaveMachine(ParseMachine(With(kMachine, "limits: {force: 25, handle_speed: 0.2}", ""), ""));
  const auto refused = [](const std::string& key, double value) {
    const std::string limit = key + ": " + std::to_string(value);
    const std::string whole = limit.substr(0, limit.find('.', key.size()));
    return MachineRefusal(With(kMachine, "force: 25, handle_speed: 0.2",
                               key == "frozen_samples" ? whole : limit))
               .find("limits." + key + " is") != std::string::npos;
  };
  int rows = 0;
  std::smatch match;
  for (std::string line; std::getline(document, line);) {
    if (!std::regex_match(line, match, row)) continue;
    ++rows;
    const std::string key = match[1];
    EXPECT_NE(defaults.find("\n  " + key + ": " + std::string(match[2]) + " "), std::string::npos)
        << key << defaults;
    const double least = std::stod(match[4]), most = std::stod(match[5]);
    EXPECT_EQ(refused(key, least), match[3].matched) << key;
    EXPECT_TRUE(refused(key, std::min(0.9 * least, least - 1e-3))) << key;
    EXPECT_FALSE(refused(key, most)) << key;
    EXPECT_TRUE(refused(key, 1.01 * most)) << key;
  }
  EXPECT_EQ(rows, 22);
}

TEST(Machine, SaysNothingOfRelativePathsWhereItIsWritten) {
  const std::string text = SaveMachine(ParseMachine(kMachine, "lab.yaml"));
  EXPECT_EQ(text.find("relative to this file"), std::string::npos) << text;
  EXPECT_NE(text.find("# URDF: package://"), std::string::npos) << text;
}

TEST(Machine, AnEnablingDeviceIsAtAnArmThatReportsItsInputs) {
  const auto with = [](const std::string& enabling) {
    return std::string(kMachine) + "enabling: " + enabling + "\n";
  };
  const Machine machine = ParseMachine(with("{arm: left, digital_input: 8}"), "lab.yaml");
  ASSERT_TRUE(machine.enabling);
  EXPECT_EQ(machine.enabling->digital_input, 8);
  EXPECT_FALSE(ParseMachine(kMachine, "lab.yaml").enabling);
  EXPECT_NE(
      MachineRefusal(with("{arm: right, digital_input: 8}")).find("FCI does not report its inputs"),
      std::string::npos);
  EXPECT_NE(MachineRefusal(with("{arm: left, digital_input: 18}")).find("digital_input"),
            std::string::npos);
  EXPECT_NE(MachineRefusal(with("{arm: middle, digital_input: 1}")).find("enabling.arm"),
            std::string::npos);
  std::string one = with("{arm: right, digital_input: 1}");
  one.erase(one.find("  right:"), one.find("limits:") - one.find("  right:"));
  EXPECT_NE(MachineRefusal(one).find("the machine has no such arm"), std::string::npos)
      << MachineRefusal(one);
}

// The height of the handles above the ground on which the person stands depends on the laboratory.
TEST(Machine, ContainsTheGroundOnWhichThePersonStands) {
  Scenario scenario = LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/box_9kg.yaml",
                                   {"safety.force=20", "safety.handle_speed=0.2"});
  ASSERT_TRUE(scenario.operator_.stance);
  const double x = scenario.operator_.stance->ground.x();
  Scenario measured = scenario;
  ApplyMachine(ParseMachine(std::string(kMachine) + "ground: -0.62\n", "lab.yaml"), &measured);
  EXPECT_EQ(measured.operator_.stance->ground, Vector3(x, 0.05, -0.62));
  // The scene is 0.2 m above the frame of the bases.
  Scenario shifted = scenario;
  shifted.environment.shift = PoseSpec{.xyz = {0, 0, 0.2}};
  ApplyMachine(ParseMachine(std::string(kMachine) + "ground: -0.62\n", "lab.yaml"), &shifted);
  EXPECT_NEAR(shifted.operator_.stance->ground.z(), -0.82, 1e-12);
  ApplyMachine(ParseMachine(kMachine, "lab.yaml"), &scenario);
  EXPECT_FALSE(scenario.operator_.stance);
}

TEST(Machine, CollisionThresholdsAreAFrankas) {
  const std::string franka = With(kMachine, "{make: franka, host: 192.0.2.11}",
                                  "{make: franka, host: 192.0.2.11, collision: {force: 35}}");
  EXPECT_EQ(ParseMachine(franka, "lab.yaml").right->connection.collision->force, 35);
  const std::string ur = With(kMachine, "{make: ur, host: 192.0.2.10}",
                              "{make: ur, host: 192.0.2.10, collision: {force: 35}}");
  EXPECT_NE(MachineRefusal(ur).find("left.connection.collision"), std::string::npos)
      << MachineRefusal(ur);
}

TEST(Machine, CannotTurnAProtectionOff) {
  for (const char* limit : {"tracking: 10", "coupling: 1e4", "max_age: 1", "frozen_samples: 100000",
                            "align_tolerance: 0.1", "relative_kp: 1000", "security_distance: 0",
                            "joint_security: 0", "relative_slack: 10"}) {
    const std::string said = MachineRefusal(With(kMachine, "handle_speed: 0.2", limit));
    const std::string key = std::string(limit).substr(0, std::string(limit).find(':'));
    EXPECT_NE(said.find("limits." + key), std::string::npos) << limit << ": " << said;
  }
}

TEST(Machine, RequiresTheLimits) {
  const auto refused = [](const std::string& what, const std::string& by, const std::string& key) {
    const std::string said = MachineRefusal(With(kMachine, what, by));
    EXPECT_NE(said.find(key), std::string::npos) << by << ": " << said;
  };
  refused("      elbow: forearm_link\n", "", "arms.left.arm.elbow is missing");
  refused("host: 192.0.2.11", "host: 192.0.2.10", "arms.right.connection.host");
  refused("sample_rate: 500", "sample_rate: 20", "arms.left.arm.sample_rate is 20 Hz");
  refused("sample_rate: 500", "sensor: {sample_rate: 20}", "arms.left.arm.sensor.sample_rate");
  refused("sample_rate: 500", "sensor: {noise_force: 100}", "arms.left.arm.sensor.noise_force");
  refused("sample_rate: 500", "sensor: {noise_torque: 10}", "arms.left.arm.sensor.noise_torque");
  refused("sample_rate: 500", "payload: {mass: 0.4, inertia: [1, 0.1, 0.1]}",
          "arms.left.arm.payload.inertia");
}

// Compares the closed form with the commands of a stop, for all accelerations that the handle can
// have.
TEST(Machine, TheWorstStopIsTheLongestOfAll) {
  for (const double jerk : {120.0, 250.0, 800.0})
    for (const double acceleration : {0.05, 2.0, 5.0, 10.0}) {
      const double speed = 0.25;
      double longest = 0, furthest = 0;
      for (int k = 0; k <= 1000; ++k) {
        const double most = std::min(acceleration, std::sqrt(jerk * speed));
        const double rate = most * k / 1000;
        StopProfile stop(acceleration, jerk, 0.001, speed);
        const double begin = speed - rate * rate / (2 * jerk);
        if (speed > StopProfile::kOvershoot * begin * (1 + 1e-9)) break;
        stop.Begin(begin, rate);
        longest = std::max(longest, stop.duration());
        furthest = std::max(furthest, stop.Distance());
      }
      const StopBudget worst = WorstStop(speed, acceleration, jerk);
      EXPECT_NEAR(worst.time, longest, 1e-2 * longest) << acceleration << " " << jerk;
      EXPECT_NEAR(worst.way, furthest, 1e-2 * furthest) << acceleration << " " << jerk;
      EXPECT_GE(worst.way, furthest * (1 - 1e-9)) << acceleration << " " << jerk;
      EXPECT_GE(worst.time, longest * (1 - 1e-9)) << acceleration << " " << jerk;
    }
  EXPECT_NEAR(WorstStop(0.25, 5, 250).time, 0.090, 1e-9);
  EXPECT_NEAR(WorstStop(0.25, 5, 250).way, 0.0134, 5e-5);
  EXPECT_NEAR(WorstStop(0.5, 5, 250).time, 0.140, 1e-9);
  EXPECT_NEAR(WorstStop(0.5, 5, 250).way, 0.0397, 5e-5);
}

TEST(Machine, MayNotBeFastWithStopsThatSufficeForTheSlow) {
  const std::string gentle = "stop_acceleration: 3.5, stop_jerk: 1000";
  EXPECT_EQ(MachineRefusal(With(kMachine, "handle_speed: 0.2", gentle + ", handle_speed: 0.25")),
            "");
  const std::string said =
      MachineRefusal(With(kMachine, "handle_speed: 0.2", gentle + ", handle_speed: 0.3"));
  EXPECT_NE(said.find("from 0.50 m/s"), std::string::npos) << said;
  EXPECT_NE(said.find("within 140 ms"), std::string::npos) << said;
  EXPECT_EQ(MachineRefusal(With(kMachine, "handle_speed: 0.2", "handle_speed: 0.5")), "");
}

// The time of 89.6 ms would be short enough, but the distance of 13.53 mm is too long.
TEST(Machine, AStopThatIsShortEnoughInTimeMayStillGoTooFar) {
  const auto stop = [](const char* jerk) {
    return With(kMachine, "handle_speed: 0.2",
                std::string("stop_acceleration: 10, handle_speed: 0.2, stop_jerk: ") + jerk);
  };
  const std::string said = MachineRefusal(stop("216"));
  EXPECT_NE(said.find("from 0.25 m/s"), std::string::npos) << said;
  EXPECT_EQ(MachineRefusal(stop("220")), "");
}

TEST(Machine, MayNotMakeStopsLongerEither) {
  const std::string slow =
      MachineRefusal(With(kMachine, "handle_speed: 0.2", "stop_acceleration: 0.05"));
  EXPECT_NE(slow.find("limits.stop_acceleration and limits.stop_jerk"), std::string::npos) << slow;
  EXPECT_NE(slow.find("lab.yaml:18:"), std::string::npos) << slow;
  EXPECT_NE(
      MachineRefusal(With(kMachine, "handle_speed: 0.2", "stop_jerk: 200")).find("within 90 ms"),
      std::string::npos);
}

}  // namespace
}  // namespace predictor
