#include "scenario/machine.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "scenario/scenario_io.h"

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
  EXPECT_NE(Refusal(With(kMachine, "make: net_ft, ", "")).find("has no address of its own"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "package://example-robot-data/robots/ur", "models/ur"))
                .find("package://"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "handle_speed: 0.2", "handle_speed: 2")).find("0.5"),
            std::string::npos);
  EXPECT_NE(Refusal(With(kMachine, "limits:", "limit:")).find("limits"), std::string::npos);
  EXPECT_NE(Refusal("predictor_machine: 1\n").find("one arm at least"), std::string::npos);
}

TEST(Machine, AnEnablingDeviceIsAtAnArmThatTellsItsInputs) {
  const auto with = [](const std::string& enabling) {
    return std::string(kMachine) + "enabling: " + enabling + "\n";
  };
  const Machine machine = ParseMachine(with("{arm: left, digital_input: 8}"), "lab.yaml");
  ASSERT_TRUE(machine.enabling);
  EXPECT_EQ(machine.enabling->digital_input, 8);
  EXPECT_FALSE(ParseMachine(kMachine, "lab.yaml").enabling);
  EXPECT_NE(Refusal(with("{arm: right, digital_input: 8}")).find("FCI tells nothing of its inputs"),
            std::string::npos);
  EXPECT_NE(Refusal(with("{arm: left, digital_input: 18}")).find("digital_input"),
            std::string::npos);
  EXPECT_NE(Refusal(with("{arm: middle, digital_input: 1}")).find("enabling.arm"),
            std::string::npos);
  std::string one = with("{arm: right, digital_input: 1}");
  one.erase(one.find("  right:"), one.find("limits:") - one.find("  right:"));
  EXPECT_NE(Refusal(one).find("the machine has none there"), std::string::npos) << Refusal(one);
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

// Each limit by itself: tightened it is taken, loosened it is refused and named.
TEST_F(ApplyMachineTest, AScenarioMayTightenNeverLoosen) {
  const std::string machine = With(kMachine, "limits: {force: 25, handle_speed: 0.2}",
                                   "limits: {force: 25, torque: 4, handle_speed: 0.2, "
                                   "handle_rotation_speed: 1, stop_acceleration: 4, "
                                   "stop_jerk: 200, align_speed: 0.04}");
  struct Case {
    const char* key;
    double machine;
  };
  const std::vector<Case> cases = {{"force", 25},
                                   {"torque", 4},
                                   {"handle_speed", 0.2},
                                   {"handle_rotation_speed", 1},
                                   {"stop_acceleration", 4},
                                   {"stop_jerk", 200},
                                   {"align_speed", 0.04}};
  std::vector<std::string> tight;
  for (const Case& c : cases)
    tight.push_back("safety." + std::string(c.key) + "=" + std::to_string(c.machine * 0.9));
  EXPECT_EQ(Refusal(Load(tight), machine), "");
  for (const Case& c : cases) {
    std::vector<std::string> one = tight;
    one.push_back("safety." + std::string(c.key) + "=" + std::to_string(c.machine * 1.01));
    const std::string said = Refusal(Load(one), machine);
    EXPECT_NE(said.find("safety." + std::string(c.key) + " is"), std::string::npos) << said;
    EXPECT_NE(said.find("never loosen"), std::string::npos) << said;
  }
}

TEST_F(ApplyMachineTest, NeedsAnArmForEachHandle) {
  std::string one = kMachine;
  one.erase(one.find("  right:"), one.find("limits:") - one.find("  right:"));
  const std::string said = Refusal(Load({"safety.force=20", "safety.handle_speed=0.2"}), one);
  EXPECT_NE(said.find("handles.right needs an arm"), std::string::npos) << said;
}

}  // namespace
}  // namespace predictor
