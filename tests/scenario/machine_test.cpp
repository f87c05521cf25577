#include "scenario/machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>

#include "core/error.h"
#include "safety/stop.h"
#include "scenario/located.h"
#include "scenario/scenario_io.h"
#include "scenario/stop_budget.h"

namespace predictor {
namespace {

constexpr const char* kMachine = R"(predictor_machine: 1
name: Two UR5
arms:
  left:
    connection: {make: ur, host: 192.0.2.10}
    sensor: {make: net_ft, host: 192.0.2.20}
    arm:
      model: package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf
      end_effector: tool0
      elbow: forearm_link
      sample_rate: 500
  right:
    connection: {make: franka, host: 192.0.2.11}
    arm:
      model: package://example-robot-data/robots/panda_description/urdf/panda.urdf
      end_effector: panda_link8
      elbow: panda_link4
limits: {force: 25, handle_speed: 0.2}
)";

std::string With(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

std::string Refusal(const std::string& text) {
  try {
    ParseMachine(text, "lab.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

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

TEST(Machine, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(Refusal(With(kMachine, "make: ur", "make: abb"))
                .find("lab.yaml:5:24: arms.left.connection.make"),
            std::string::npos)
      << Refusal(With(kMachine, "make: ur", "make: abb"));
  EXPECT_NE(Refusal(With(kMachine, ", host: 192.0.2.20", "")).find("sensor.host is missing"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "make: net_ft, ", "")).find("has no separate address"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "package://example-robot-data/robots/ur", "models/ur"))
                .find("package://"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "handle_speed: 0.2", "handle_speed: 2")).find("0.5"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "limits:", "limit:")).find("limits"), std::string::npos);
  EXPECT_NE(Refusal("predictor_machine: 1\n").find("needs at least one arm"), std::string::npos);
}

TEST(Machine, AnAddressInNumbersIsOne) {
  for (const char* host : {"300.1.1.1", "192.0.2", "192.0.2.10:30004", "192.0.2.10.1", "fe80::1"}) {
    const std::string quoted = "\"" + std::string(host) + "\"";
    const std::string arm = Refusal(With(kMachine, "192.0.2.10", quoted));
    EXPECT_NE(arm.find("lab.yaml:5:34: arms.left.connection.host is " + quoted +
                       ", which is not an IPv4 address"),
              std::string::npos)
        << arm;
    const std::string sensor = Refusal(With(kMachine, "192.0.2.20", quoted));
    EXPECT_NE(sensor.find("arms.left.sensor.host is " + quoted), std::string::npos) << sensor;
  }
  EXPECT_EQ(Refusal(With(kMachine, "192.0.2.10", "ur-in-room-12")), "");
}

TEST(Machine, EachArmAndEachSensorHasItsOwnAddress) {
  EXPECT_EQ(Refusal(With(kMachine, "192.0.2.11", "192.0.2.10")),
            "lab.yaml:13:38: arms.right.connection.host is also the address of the left arm. Give "
            "each arm its own address.");
  const auto sensor = [](const std::string& host) {
    return With(kMachine, "host: 192.0.2.11}\n",
                "host: 192.0.2.11}\n    sensor: {make: net_ft, host: " + host + "}\n");
  };
  EXPECT_EQ(Refusal(sensor("192.0.2.20")),
            "lab.yaml:14:34: arms.right.sensor.host is also the address of the left sensor, but "
            "one sensor cannot measure both hands. Give each sensor its own address.");
  EXPECT_EQ(Refusal(sensor("192.0.2.21")), "");
  // Sensors that belong to an arm have no address of their own.
  EXPECT_EQ(Refusal(With(kMachine, "    sensor: {make: net_ft, host: 192.0.2.20}\n", "")), "");
}

TEST(Machine, AMisspeltGroupIsToldOnce) {
  EXPECT_EQ(Refusal(With(kMachine, "connection:", "conection:")),
            "lab.yaml:5:5: \"conection\" is not a key of arms.left. Did you mean connection?");
  EXPECT_EQ(Refusal(With(kMachine, "arms:", "arm:")),
            "lab.yaml:3:1: \"arm\" is not a key. Did you mean arms?");
  // A word that resembles no key is not taken for another key.
  EXPECT_NE(Refusal(With(kMachine, "connection:", "wire:")).find("connection.make is missing"),
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
    return Refusal(With(kMachine, "force: 25, handle_speed: 0.2",
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

TEST(Machine, AnEnablingDeviceIsAtAnArmThatTellsItsInputs) {
  const auto with = [](const std::string& enabling) {
    return std::string(kMachine) + "enabling: " + enabling + "\n";
  };
  const Machine machine = ParseMachine(with("{arm: left, digital_input: 8}"), "lab.yaml");
  ASSERT_TRUE(machine.enabling);
  EXPECT_EQ(machine.enabling->digital_input, 8);
  EXPECT_FALSE(ParseMachine(kMachine, "lab.yaml").enabling);
  EXPECT_NE(Refusal(with("{arm: right, digital_input: 8}")).find("FCI does not report its inputs"),
            std::string::npos);
  EXPECT_NE(Refusal(with("{arm: left, digital_input: 18}")).find("digital_input"),
            std::string::npos);
  EXPECT_NE(Refusal(with("{arm: middle, digital_input: 1}")).find("enabling.arm"),
            std::string::npos);
  std::string one = with("{arm: right, digital_input: 1}");
  one.erase(one.find("  right:"), one.find("limits:") - one.find("  right:"));
  EXPECT_NE(Refusal(one).find("the machine has no such arm"), std::string::npos) << Refusal(one);
}

TEST(Machine, CollisionThresholdsAreAFrankas) {
  const std::string franka = With(kMachine, "{make: franka, host: 192.0.2.11}",
                                  "{make: franka, host: 192.0.2.11, collision: {force: 35}}");
  EXPECT_EQ(ParseMachine(franka, "lab.yaml").right->connection.collision->force, 35);
  const std::string ur = With(kMachine, "{make: ur, host: 192.0.2.10}",
                              "{make: ur, host: 192.0.2.10, collision: {force: 35}}");
  EXPECT_NE(Refusal(ur).find("left.connection.collision"), std::string::npos) << Refusal(ur);
}

class ApplyMachineTest : public testing::Test {
 protected:
  static Scenario Load(const std::vector<std::string>& set = {}) {
    std::vector<std::string> all = {"device.type=real", "operator.type=person"};
    all.insert(all.end(), set.begin(), set.end());
    return LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/box_9kg.yaml", all);
  }
  static std::string Refusal(Scenario scenario, const std::string& machine = kMachine) {
    try {
      ApplyMachine(ParseMachine(machine, "lab.yaml"), &scenario);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(ApplyMachineTest, PutsTheMachinesArmsInPlace) {
  Scenario scenario = Load({"safety.force=20", "safety.handle_speed=0.2"});
  ApplyMachine(ParseMachine(kMachine, "lab.yaml"), &scenario);
  EXPECT_EQ(scenario.device.type, "real");
  EXPECT_EQ(scenario.arm(0).end_effector, "tool0");
  EXPECT_EQ(scenario.arm(1).end_effector, "panda_link8");
}

TEST_F(ApplyMachineTest, AFrankaComesToWhereItsVelocitiesLead) {
  Scenario scenario = Load({"safety.force=20", "safety.handle_speed=0.2"});
  ApplyMachine(ParseMachine(kMachine, "lab.yaml"), &scenario);
  EXPECT_FALSE(scenario.arm(0).follows_position);
  EXPECT_TRUE(scenario.arm(1).follows_position);
}

// Each limit separately: a tighter value is accepted, a looser one is refused and named.
TEST_F(ApplyMachineTest, AScenarioMayTightenNeverLoosen) {
  const std::string machine = With(kMachine, "limits: {force: 25, handle_speed: 0.2}",
                                   "limits: {force: 25, torque: 4, handle_speed: 0.2, "
                                   "handle_rotation_speed: 1, stop_acceleration: 5, "
                                   "stop_jerk: 300, align_speed: 0.04, coupling: 60, "
                                   "max_age: 0.004, security_distance: 0.2}");
  struct Case {
    const char* path;
    double machine;
    bool least = false;
  };
  const std::vector<Case> cases = {{"safety.force", 25},
                                   {"safety.torque", 4},
                                   {"safety.handle_speed", 0.2},
                                   {"safety.handle_rotation_speed", 1},
                                   {"safety.stop_acceleration", 5, true},
                                   {"safety.stop_jerk", 300, true},
                                   {"safety.align_speed", 0.04},
                                   {"safety.align_tolerance", 0.002},
                                   {"safety.align_tolerance_rotation", 0.01745},
                                   {"safety.tracking", 0.05},
                                   {"safety.tracking_rotation", 0.35},
                                   {"safety.relative_slack", 0.002},
                                   {"safety.relative_slack_rotation", 0.00873},
                                   {"safety.relative_slack_time", 0.05},
                                   {"safety.coupling", 60},
                                   {"safety.coupling_torque", 15},
                                   {"safety.max_age", 0.004},
                                   {"safety.frozen_samples", 50},
                                   {"rendering.relative_kp", 1},
                                   {"rendering.relative_ko", 0.9},
                                   {"rendering.security_distance", 0.2, true},
                                   {"rendering.joint_security", 0.02, true}};
  const auto set = [](const Case& c, double factor) {
    const std::string path = c.path;
    const double value = c.machine * (c.least ? 1 / factor : factor);
    return path + "=" +
           (path.ends_with("samples") ? std::to_string(std::lround(value)) : std::to_string(value));
  };
  std::vector<std::string> tight;
  tight.reserve(cases.size());
  for (const Case& c : cases) tight.push_back(set(c, 0.9));
  EXPECT_EQ(Refusal(Load(tight), machine), "");
  for (const Case& c : cases) {
    std::vector<std::string> one = tight;
    one.push_back(set(c, 1.02));
    const std::string said = Refusal(Load(one), machine), path = c.path;
    EXPECT_NE(said.find(path + " is"), std::string::npos) << said;
    EXPECT_NE(said.find("not loosen them"), std::string::npos) << said;
    EXPECT_NE(said.find(std::string(c.least ? " at least" : " at most") + " (limits" +
                        path.substr(path.find('.')) + " of lab.yaml)"),
              std::string::npos)
        << said;
  }
}

// Deadlines, the watchdog's timeout and the age of samples are counted in ticks of one millisecond.
TEST_F(ApplyMachineTest, RealArmsTickAtAThousandHertz) {
  const std::string machine =
      With(kMachine, "limits: {force: 25, handle_speed: 0.2}", "limits: {force: 30}");
  EXPECT_EQ(Refusal(Load({"rate=1000"}), machine), "");
  for (const char* rate : {"100", "200", "500"}) {
    const std::string said = Refusal(Load({std::string("rate=") + rate}), machine);
    EXPECT_EQ(said, std::string("--set rate: rate is ") + rate +
                        " Hz, but real arms need a rate of 1000 Hz, because slower ticks would "
                        "delay a stop. Remove this key.");
  }
}

TEST_F(ApplyMachineTest, ElbowsDoNotDrawTheHandlesAway) {
  const std::string machine =
      With(kMachine, "limits: {force: 25, handle_speed: 0.2}", "limits: {force: 30}");
  EXPECT_EQ(Refusal(Load({"rendering.manipulability=0.01"}), machine), "");
  EXPECT_EQ(
      Refusal(Load({"rendering.manipulability=0.011"}), machine),
      "--set rendering.manipulability: rendering.manipulability is 0.011; with real arms it must "
      "be 0.01 or less, because a larger value moves the handles away from their targets.");
}

// No machine file can disable the detection of oscillations.
TEST_F(ApplyMachineTest, TheSearchForOscillationsStays) {
  const std::string machine =
      With(kMachine, "limits: {force: 25, handle_speed: 0.2}", "limits: {force: 30}");
  for (const char* off :
       {"enabled=false", "low=0.5", "low=0.19", "high=9", "cycles=4", "amplitude=2.1"}) {
    const std::string said = Refusal(Load({"safety.oscillation." + std::string(off)}), machine);
    const std::string key = std::string(off).substr(0, std::string(off).find('='));
    EXPECT_NE(said.find("safety.oscillation." + key + " is"), std::string::npos) << said;
    EXPECT_NE(said.find("Remove this key."), std::string::npos) << said;
  }
  EXPECT_EQ(Refusal(Load({"safety.oscillation.amplitude=1.5", "safety.oscillation.cycles=2",
                          "safety.oscillation.low=0.3", "safety.oscillation.high=12"}),
                    machine),
            "");
}

TEST(Machine, CannotTurnAProtectionOff) {
  for (const char* limit : {"tracking: 10", "coupling: 1e4", "max_age: 1", "frozen_samples: 100000",
                            "align_tolerance: 0.1", "relative_kp: 1000", "security_distance: 0",
                            "joint_security: 0", "relative_slack: 10"}) {
    const std::string said = Refusal(With(kMachine, "handle_speed: 0.2", limit));
    const std::string key = std::string(limit).substr(0, std::string(limit).find(':'));
    EXPECT_NE(said.find("limits." + key), std::string::npos) << limit << ": " << said;
  }
}

TEST(Machine, CannotLeaveOutWhatItIsJudgedBy) {
  const auto refused = [](const std::string& what, const std::string& by, const std::string& key) {
    const std::string said = Refusal(With(kMachine, what, by));
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

// Compares the closed form with the stop as it is sent, for all possible accelerations of the
// handle.
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
  EXPECT_EQ(Refusal(With(kMachine, "handle_speed: 0.2", gentle + ", handle_speed: 0.25")), "");
  const std::string said =
      Refusal(With(kMachine, "handle_speed: 0.2", gentle + ", handle_speed: 0.3"));
  EXPECT_NE(said.find("from 0.50 m/s"), std::string::npos) << said;
  EXPECT_NE(said.find("within 140 ms"), std::string::npos) << said;
  EXPECT_EQ(Refusal(With(kMachine, "handle_speed: 0.2", "handle_speed: 0.5")), "");
}

// 89.6 ms would be short enough, but 13.53 mm is too far.
TEST(Machine, AStopThatIsShortEnoughInTimeMayStillGoTooFar) {
  const auto stop = [](const char* jerk) {
    return With(kMachine, "handle_speed: 0.2",
                std::string("stop_acceleration: 10, handle_speed: 0.2, stop_jerk: ") + jerk);
  };
  const std::string said = Refusal(stop("216"));
  EXPECT_NE(said.find("from 0.25 m/s"), std::string::npos) << said;
  EXPECT_EQ(Refusal(stop("220")), "");
}

TEST_F(ApplyMachineTest, AStopKeepsItsBudget) {
  const std::string machine =
      With(kMachine, "limits: {force: 25, handle_speed: 0.2}", "limits: {force: 30}");
  EXPECT_EQ(Refusal(Load(), machine), "");
  EXPECT_EQ(Refusal(Load({"safety.stop_acceleration=6", "safety.stop_jerk=500"}), machine), "");
  EXPECT_NE(Refusal(Load({"safety.stop_acceleration=0.05"}), machine).find("5 m/s² at least"),
            std::string::npos);
  const std::string blow =
      Refusal(Load({"safety.stop_acceleration=50", "safety.stop_jerk=5000"}), machine);
  EXPECT_NE(blow.find("too abrupt"), std::string::npos) << blow;
  for (const char* one : {"safety.stop_acceleration=11", "safety.stop_jerk=1100"})
    EXPECT_NE(Refusal(Load({one}), machine).find("too abrupt"), std::string::npos) << one;
  EXPECT_NE(blow.find("safety.stop_acceleration and safety.stop_jerk"), std::string::npos) << blow;
}

TEST(Machine, MayNotMakeStopsLongerEither) {
  const std::string slow = Refusal(With(kMachine, "handle_speed: 0.2", "stop_acceleration: 0.05"));
  EXPECT_NE(slow.find("limits.stop_acceleration and limits.stop_jerk"), std::string::npos) << slow;
  EXPECT_NE(slow.find("lab.yaml:18:"), std::string::npos) << slow;
  EXPECT_NE(Refusal(With(kMachine, "handle_speed: 0.2", "stop_jerk: 200")).find("within 90 ms"),
            std::string::npos);
}

// Without a measured loop there is no lag compensation, whatever the scenario requests.
TEST_F(ApplyMachineTest, AGuessedLoopGivesNoLead) {
  Machine machine = ParseMachine(kMachine, "lab.yaml");
  const auto lead = [&](const char* set) {
    Scenario scenario = Load({"safety.force=20", "safety.handle_speed=0.2", set});
    ApplyMachine(machine, &scenario);
    return scenario.rendering.lead.value_or(-1);
  };
  const auto measured = [](MachineArm* arm) {
    if (!arm->commissioned) arm->commissioned.emplace();
    arm->commissioned->loop = "2026-01-02";
    arm->commissioned->loop_of = HashOfLoop(*arm);
  };
  const auto told = [&] { return UnmeasuredLoops(machine, Load()); };
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
  EXPECT_EQ(lead("rendering.lead=0.05"), 0);
  ASSERT_EQ(told().size(), 2u);
  EXPECT_NE(told()[1].find("`predictor calibrate loop --machine lab.yaml --arm right`"),
            std::string::npos)
      << told()[1];
  measured(&*machine.left);
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
  measured(&*machine.right);
  EXPECT_EQ(lead("rendering.lead=auto"), -1);
  EXPECT_EQ(lead("rendering.lead=0.05"), 0.05);
  EXPECT_TRUE(told().empty());
  // The machine file is read back as it was written, and it contains no push tests.
  machine = ParseMachine(SaveMachine(machine), "lab.yaml");
  EXPECT_EQ(lead("rendering.lead=auto"), -1);
  EXPECT_FALSE(IsPushTested(*machine.left));
  EXPECT_THROW(RequirePushTests(machine, Load()), InputError);
  // Another payload does not invalidate the measured loop. Other loop parameters or another arm at
  // this place do.
  machine.left->arm.payload.mass += 1;
  EXPECT_EQ(lead("rendering.lead=auto"), -1);
  machine.left->arm.loop.bandwidth += 1;
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
  EXPECT_NE(told()[0].find("with its present settings"), std::string::npos) << told()[0];
  measured(&*machine.left);
  machine.left->connection.host = "192.0.2.99";
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
}

// Errors that are detected only after the models are loaded.
TEST_F(ApplyMachineTest, ErrorsOfItsArmsAreToldInItsFile) {
  Scenario scenario = Load({"safety.force=20", "safety.handle_speed=0.2"});
  const auto told = [&](const char* key) {
    return std::string(
        Located(InputError::At(key, std::string(key) + " is bad."), scenario).what());
  };
  EXPECT_NE(told("device.arms.left.elbow").find("box_9kg.yaml:"), std::string::npos);
  EXPECT_EQ(ArmKey(scenario, 0), "device.arms.left");
  ApplyMachine(ParseMachine(kMachine, "lab.yaml"), &scenario);
  EXPECT_EQ(told("device.arms.left.elbow"), "lab.yaml:10:14: arms.left.arm.elbow is bad.");
  EXPECT_EQ(told("device.arms.right.model"), "lab.yaml:15:14: arms.right.arm.model is bad.");
  EXPECT_EQ(told("device.arms.right.posture"), "lab.yaml:15:7: arms.right.arm.posture is bad.");
  EXPECT_NE(told("cobot.model").find("box_9kg.yaml:"), std::string::npos);
  EXPECT_EQ(ArmKey(scenario, 1), "arms.right.arm");
}

TEST_F(ApplyMachineTest, UntestedPushesAreToldOfEachArm) {
  Machine machine = ParseMachine(kMachine, "lab.yaml");
  const auto told = [&] { return UntestedPushes(machine, Load()); };
  ASSERT_EQ(told().size(), 2u);
  EXPECT_NE(told()[0].find("arms.left has not passed a push test"), std::string::npos);
  EXPECT_NE(told()[1].find("`predictor calibrate push --machine lab.yaml --arm right`"),
            std::string::npos);
  machine.left->commissioned.emplace();
  machine.left->commissioned->of = HashOf(*machine.left);
  ASSERT_EQ(told().size(), 1u);
  machine.left->arm.payload.mass += 1;
  EXPECT_NE(told()[0].find("arms.left was changed after"), std::string::npos) << told()[0];
}

TEST_F(ApplyMachineTest, LoopsComeBeforeThePushesThatTheyWouldVoid) {
  Machine machine = ParseMachine(kMachine, "lab.yaml");
  const auto told = [&]() -> std::string {
    try {
      RequirePushTests(machine, Load());
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* part : {"arms.left has not passed a push test", "--arm left", "arms.right has not passed a push test",
                           "--arm right", "`predictor calibrate loop`"})
    EXPECT_NE(told().find(part), std::string::npos) << part << "\n" << told();
  for (std::optional<MachineArm>* arm : {&machine.left, &machine.right}) {
    (*arm)->commissioned.emplace();
    (*arm)->commissioned->loop = "2026-11-23";
    (*arm)->commissioned->loop_of = HashOfLoop(**arm);
  }
  EXPECT_NE(told().find("arms.right has not passed a push test"), std::string::npos) << told();
  EXPECT_EQ(told().find("calibrate loop"), std::string::npos) << told();
}

TEST_F(ApplyMachineTest, ArmsThatAreLeftOutNeedNoMachine) {
  Scenario direct = Load();
  direct.mode = Mode::kDirect;
  const std::string said = Refusal(direct);
  EXPECT_NE(said.find("mode is direct"), std::string::npos) << said;
}

TEST_F(ApplyMachineTest, NeedsAnArmForEachHandle) {
  std::string one = kMachine;
  one.erase(one.find("  right:"), one.find("limits:") - one.find("  right:"));
  const std::string said = Refusal(Load({"safety.force=20", "safety.handle_speed=0.2"}), one);
  EXPECT_NE(said.find("handles.right needs an arm"), std::string::npos) << said;
}

}  // namespace
}  // namespace predictor
