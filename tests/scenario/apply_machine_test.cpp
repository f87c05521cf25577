// Tests scenarios on a machine. The machine file determines some values and rejects others.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenario/located.h"
#include "scenario/scenario_io.h"
#include "scenario/two_arm_machine.h"

namespace predictor {
namespace {

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

TEST_F(ApplyMachineTest, AFrankasPositionIntegratesItsVelocities) {
  Scenario scenario = Load({"safety.force=20", "safety.handle_speed=0.2"});
  ApplyMachine(ParseMachine(kMachine, "lab.yaml"), &scenario);
  EXPECT_FALSE(scenario.arm(0).follows_position);
  EXPECT_TRUE(scenario.arm(1).follows_position);
}

// The test changes each limit separately. The program must accept a tighter value. It must refuse a
// looser value and name it.
TEST_F(ApplyMachineTest, AScenarioMayOnlyTightenLimits) {
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

// A machine file must not be able to disable the detection of oscillations.
TEST_F(ApplyMachineTest, TheDetectionOfOscillationsStaysOn) {
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

// Without a measured loop, the program must not compensate the lag, whatever the scenario requests.
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
  const auto reported = [&] { return UnmeasuredLoops(machine, Load()); };
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
  EXPECT_EQ(lead("rendering.lead=0.05"), 0);
  ASSERT_EQ(reported().size(), 2u);
  EXPECT_NE(reported()[1].find("`predictor calibrate loop --machine lab.yaml --arm right`"),
            std::string::npos)
      << reported()[1];
  measured(&*machine.left);
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
  measured(&*machine.right);
  EXPECT_EQ(lead("rendering.lead=auto"), -1);
  EXPECT_EQ(lead("rendering.lead=0.05"), 0.05);
  EXPECT_TRUE(reported().empty());
  // The program reads the machine file as it was written, without push tests.
  machine = ParseMachine(SaveMachine(machine), "lab.yaml");
  EXPECT_EQ(lead("rendering.lead=auto"), -1);
  EXPECT_FALSE(IsPushTested(*machine.left));
  EXPECT_THROW(RequirePushTests(machine, Load()), InputError);
  // Another payload must not invalidate the measured loop. Other loop parameters, or another arm at
  // this place, must invalidate it.
  machine.left->arm.payload.mass += 1;
  EXPECT_EQ(lead("rendering.lead=auto"), -1);
  machine.left->arm.loop.bandwidth += 1;
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
  EXPECT_NE(reported()[0].find("with its present settings"), std::string::npos) << reported()[0];
  measured(&*machine.left);
  machine.left->connection.host = "192.0.2.99";
  EXPECT_EQ(lead("rendering.lead=auto"), 0);
}

// The program detects these errors only after it has loaded the models.
TEST_F(ApplyMachineTest, ErrorsOfItsArmsAreReportedInItsFile) {
  Scenario scenario = Load({"safety.force=20", "safety.handle_speed=0.2"});
  const auto reported = [&](const char* key) {
    return std::string(
        Located(InputError::At(key, std::string(key) + " is bad."), scenario).what());
  };
  EXPECT_NE(reported("device.arms.left.elbow").find("box_9kg.yaml:"), std::string::npos);
  EXPECT_EQ(ArmKey(scenario, 0), "device.arms.left");
  ApplyMachine(ParseMachine(kMachine, "lab.yaml"), &scenario);
  EXPECT_EQ(reported("device.arms.left.elbow"), "lab.yaml:10:14: arms.left.arm.elbow is bad.");
  EXPECT_EQ(reported("device.arms.right.model"), "lab.yaml:15:14: arms.right.arm.model is bad.");
  EXPECT_EQ(reported("device.arms.right.posture"), "lab.yaml:15:7: arms.right.arm.posture is bad.");
  EXPECT_NE(reported("cobot.model").find("box_9kg.yaml:"), std::string::npos);
  EXPECT_EQ(ArmKey(scenario, 1), "arms.right.arm");
}

TEST_F(ApplyMachineTest, UntestedPushesAreReportedForEachArm) {
  Machine machine = ParseMachine(kMachine, "lab.yaml");
  const auto reported = [&] { return UntestedPushes(machine, Load()); };
  ASSERT_EQ(reported().size(), 2u);
  EXPECT_NE(reported()[0].find("arms.left has not passed a push test"), std::string::npos);
  EXPECT_NE(reported()[1].find("`predictor calibrate push --machine lab.yaml --arm right`"),
            std::string::npos);
  machine.left->commissioned.emplace();
  machine.left->commissioned->of = HashOf(*machine.left);
  ASSERT_EQ(reported().size(), 1u);
  machine.left->arm.payload.mass += 1;
  EXPECT_NE(reported()[0].find("arms.left was changed after"), std::string::npos) << reported()[0];
}

TEST_F(ApplyMachineTest, LoopsAreMeasuredBeforeThePushTestsThatTheyInvalidate) {
  Machine machine = ParseMachine(kMachine, "lab.yaml");
  const auto reported = [&]() -> std::string {
    try {
      RequirePushTests(machine, Load());
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* part :
       {"arms.left has not passed a push test", "--arm left",
        "arms.right has not passed a push test", "--arm right", "`predictor calibrate loop`"})
    EXPECT_NE(reported().find(part), std::string::npos) << part << "\n" << reported();
  for (std::optional<MachineArm>* arm : {&machine.left, &machine.right}) {
    (*arm)->commissioned.emplace();
    (*arm)->commissioned->loop = "2026-11-23";
    (*arm)->commissioned->loop_of = HashOfLoop(**arm);
  }
  EXPECT_NE(reported().find("arms.right has not passed a push test"), std::string::npos)
      << reported();
  EXPECT_EQ(reported().find("calibrate loop"), std::string::npos) << reported();
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
