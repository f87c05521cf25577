// Tests `predictor devices` and `predictor calibrate` as a person at a rig uses them: at a terminal
// and over real sockets. In these tests, the arms do not move by themselves.
// commission_loop_test.cpp covers motion by the program.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "machine/commissioning_fixture.h"
#include "models/robot.h"

namespace predictor {
namespace {

// Returns the first number that the parentheses in `pattern` capture.
double NumberIn(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? std::stod(match[1]) : NAN;
}

// ---- devices ------------------------------------------------------------------------------------

TEST_F(Commissioning, DevicesReportsWhichAnswerAndContinuesIfOneDoesNot) {
  SwitchOn();
  {
    Terminal all = Predictor({"devices", "--duration", "0.5"});
    EXPECT_EQ(all.Wait(), 0) << all.Screen();
    for (const std::string& part :
         {std::string("left arm: Universal Robots e-Series, PolyScope 5.12"),
          "at " + HostOf(kRight), std::string("never run on hardware"), std::string("wrench now")})
      EXPECT_NE(all.Screen().find(part), std::string::npos) << part << "\n" << all.Screen();
  }
  {
    SwitchOn({Left(",payload=1.2"), Right()});
    rig_->Ask("do right 0 slider 70");
    Terminal reported = Predictor({"devices", "--duration", "0.5"});
    EXPECT_EQ(reported.Wait(), 0) << reported.Screen();
    EXPECT_NE(reported.Screen().find("is set to 1.20 kg at the flange"), std::string::npos)
        << reported.Screen();
    EXPECT_NE(reported.Screen().find("speed slider is at 70 %"), std::string::npos)
        << reported.Screen();
  }
  {
    SwitchOn();
    folder_.Change([](Machine* machine) {  // resembles a CB3 and an arm of seven joints
      machine->left->arm.sample_rate = 125;
      machine->right->arm = LoadScenario(FileOf("box_9kg")).arm(1);
    });
    Terminal others = Predictor({"devices", "--duration", "0.5"});
    EXPECT_EQ(others.Wait(), kUnfit) << others.Screen();
    for (const char* part : {"500 samples per second, but the machine file says 125",
                             "arms.right.arm.model has 7 joints, but the arm that answers has 6"})
      EXPECT_NE(others.Screen().find(part), std::string::npos) << part << "\n" << others.Screen();
  }
  SwitchOn({Right()});
  Terminal one = Predictor({"devices", "--duration", "0.5"});
  EXPECT_EQ(one.Wait(), kDeviceFailure);
  EXPECT_NE(one.Screen().find("left arm: DOES NOT ANSWER"), std::string::npos) << one.Screen();
  EXPECT_NE(one.Screen().find(HostOf(kLeft) + ":30004"), std::string::npos) << one.Screen();
  EXPECT_NE(one.Screen().find("right arm: Universal Robots"), std::string::npos) << one.Screen();
}

// ---- the handle ---------------------------------------------------------------------------------

TEST_F(Commissioning, TheHandleIsFoundInPosesToWhichAPersonGuides) {
  SwitchOn();
  folder_.Change([](Machine* machine) {  // removes the measurement of the handle
    machine->left->arm.payload = {};
    machine->left->arm.payload.mass = 0;
  });
  folder_.NotePushTests();
  const JointVector start = Joints("left");
  const double tilts[][3] = {{0, 0, 0},    {1.2, 0, 0}, {-1.2, 0, 0},   {0, 1.2, 0},
                             {0, -1.2, 0}, {0.8, 1, 0}, {-0.7, 0.9, 1}, {1.9, -0.4, -1}};
  Terminal terminal = Predictor({"calibrate", "handle", "--arm", "left", "--json", ResultFile()});
  for (int pose = 1; pose <= 8; ++pose) {
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + ": press Enter"))
        << terminal.Screen();
    JointVector q = start;
    for (int j = 0; j < 3; ++j) q[3 + j] += tilts[pose - 1][j];
    Lead("left", q);
    terminal.Type("\n");
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + " taken")) << terminal.Screen();
  }
  terminal.Type("d");
  ASSERT_TRUE(terminal.Says("Write these values to")) << terminal.Screen();
  terminal.Type("y");
  EXPECT_EQ(terminal.Wait(), 0);
  const std::string said = terminal.Screen();
  EXPECT_NE(said.find("run `predictor calibrate push --machine "), std::string::npos) << said;

  const HandlePayloadSpec& truth = scenario_.arm(0).payload;
  const HandlePayloadSpec found = folder_.machine().left->arm.payload;
  EXPECT_NEAR(found.mass, truth.mass, 0.01 * truth.mass) << said;
  const double mass_sure = NumberIn(said, "mass +[-0-9.]+ ± ([0-9.]+) kg");
  EXPECT_LT(mass_sure, 0.01 * truth.mass) << said;
  EXPECT_GT(mass_sure, 0) << said;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    EXPECT_NEAR(found.center_of_mass[i], truth.center_of_mass[i], 0.001) << said;
    const double sure = NumberIn(said, "centre of mass " + axis + " +[-0-9.]+ ± ([0-9.]+) mm");
    EXPECT_GT(sure, 0) << said;
    EXPECT_LT(sure, 1) << said;
    const std::string bias = "force  " + axis + " +([-0-9.]+) ± ([0-9.]+) N";
    EXPECT_NEAR(NumberIn(said, bias), scenario_.rig.sensor_bias[static_cast<std::size_t>(i)], 0.05)
        << said;
    const double bias_sure = NumberIn(said, "force  " + axis + " +[-0-9.]+ ± ([0-9.]+) N");
    EXPECT_GT(bias_sure, 0) << said;
    EXPECT_LT(bias_sure, 0.05) << said;
  }
  const nlohmann::json result = Result();
  EXPECT_EQ(result["arm"], "left");
  EXPECT_EQ(result["written"], true);
  EXPECT_EQ(result["found"]["poses"], 8);
  EXPECT_NEAR(result["found"]["mass_kg"]["value"].get<double>(), found.mass, 1e-9);
  // After this change, a person must repeat the push tests.
  EXPECT_FALSE(IsPushTested(*folder_.machine().left));
  EXPECT_TRUE(IsPushTested(*folder_.machine().right));
}

TEST_F(Commissioning, PosesThatAreTooAlikeAreRefusedAndNothingIsWritten) {
  SwitchOn();
  const std::string before = HashOf(*folder_.machine().left);
  Terminal terminal = Predictor({"calibrate", "handle", "--arm", "left"});
  JointVector q = Joints("left");
  for (int pose = 1; pose <= 6; ++pose) {
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + ": press Enter"))
        << terminal.Screen();
    q[5] += 0.3;  // a rotation about the vertical keeps the direction of gravity
    Lead("left", q);
    terminal.Type("\n");
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + " taken")) << terminal.Screen();
  }
  terminal.Type("d");
  EXPECT_TRUE(terminal.Says("too alike")) << terminal.Screen();
  ASSERT_TRUE(terminal.Says("Pose 7: press Enter")) << terminal.Screen();
  terminal.Type("q");
  EXPECT_EQ(terminal.Wait(), kBadInput);
  EXPECT_NE(terminal.Screen().find("Cancelled. The machine file was not changed any further."),
            std::string::npos);
  EXPECT_EQ(HashOf(*folder_.machine().left), before);
}

// ---- the bases ----------------------------------------------------------------------------------

TEST_F(Commissioning, TheBasesAreFoundByTouchingCommonPoints) {
  SwitchOn();
  folder_.Change([](Machine* machine) {
    machine->right->arm.base.xyz += Vector3(0.03, -0.02, 0.01);
    machine->right->arm.base.rpy += Vector3(0.01, 0, 0.04);
  });
  const Vector3 tip(0, 0, 0.18);
  const auto joints = [&](int hand, const Vector3& point) {
    const ArmSpec& spec = scenario_.arm(hand);
    const auto model = RobotModel::Load({spec.model, {}, spec.remove_links, spec.base.X_RB()});
    JointVector q = Joints(kHandNames[static_cast<std::size_t>(hand)]);
    const FrameId end = model->Frame(spec.end_effector, {tip, {1, 0, 0, 0}});
    EXPECT_TRUE(SolveInverseKinematics(
        *model, end, {point, RotationFromVector({std::numbers::pi, 0, 0})}, q, 50, &q));
    return q;
  };
  const Vector3 points[] = {
      {0.55, -0.1, 0.1}, {0.7, 0.1, 0.1}, {0.6, 0.12, 0.3}, {0.5, -0.05, 0.25}, {0.65, -0.12, 0.2}};
  Terminal terminal =
      Predictor({"calibrate", "bases", "--json", ResultFile(), "--tip", "0", "0", "0.18"});
  for (const int hand : {0, 1}) {
    for (std::size_t i = 0; i < std::size(points); ++i) {
      const std::string name = kHandNames[static_cast<std::size_t>(hand)];
      ASSERT_TRUE(terminal.Says("Touch point " + std::to_string(i + 1) + " with the tip of the " +
                                name + " arm"))
          << terminal.Screen();
      Lead(name, joints(hand, points[i]));
      terminal.Type("\n");
      ASSERT_TRUE(terminal.Says("mm in its base.")) << terminal.Screen();
    }
    if (hand == 1) continue;
    ASSERT_TRUE(terminal.Says("or d if all points are done")) << terminal.Screen();
    terminal.Type("d");
  }
  ASSERT_TRUE(terminal.Says("Write these values to")) << terminal.Screen();
  terminal.Type("y");
  EXPECT_EQ(terminal.Wait(), 0);
  const Pose found = folder_.machine().right->arm.base.X_RB();
  const Pose truth = scenario_.arm(1).base.X_RB();
  EXPECT_LT((found.p - truth.p).norm(), 0.001) << terminal.Screen();
  EXPECT_LT(RotationError(found.q, truth.q).norm(), 0.002) << terminal.Screen();
  EXPECT_LT(NumberIn(terminal.Screen(), "([0-9.]+) mm rms"), 1) << terminal.Screen();
  const nlohmann::json result = Result();
  EXPECT_EQ(result["arm"], "right");
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(result["found"]["xyz_m"][static_cast<std::size_t>(i)].get<double>(), found.p[i],
                1e-6);
}

// ---- push tests ---------------------------------------------------------------------------------

TEST_F(Commissioning, CorrectPushesAreRecordedForBothArms) {
  SwitchOn();
  Terminal terminal = Predictor({"calibrate", "push", "--json", ResultFile()});
  PushOne(&terminal);
  EXPECT_TRUE(terminal.Says("The left handle's readings agree with the pushes."))
      << terminal.Screen();
  PushOne(&terminal);
  EXPECT_TRUE(terminal.Says("The right handle's readings agree with the pushes."))
      << terminal.Screen();
  EXPECT_EQ(terminal.Wait(), 0);
  EXPECT_TRUE(IsPushTested(*folder_.machine().left));
  EXPECT_TRUE(IsPushTested(*folder_.machine().right));
  const nlohmann::json passed = Result()["passed"];
  ASSERT_EQ(passed.size(), 2U);
  EXPECT_EQ(passed[1]["arm"], "right");
}

struct Wiring {
  const char* name;
  const char* axes;  // of the left arm's sensor
  const char* says;
};

class WrongWiring : public Commissioning, public testing::WithParamInterface<Wiring> {};

TEST_P(WrongWiring, IsRefusedAndNotNoted) {
  SwitchOn();
  ASSERT_EQ(rig_->Ask(std::string("wire left ") + GetParam().axes), "ok");
  Terminal terminal = Predictor({"calibrate", "push", "--arm", "left"});
  PushOne(&terminal);
  EXPECT_EQ(terminal.Wait(), kBadInput);
  EXPECT_NE(terminal.Screen().find(GetParam().says), std::string::npos) << terminal.Screen();
  EXPECT_FALSE(IsPushTested(*folder_.machine().left));
}

INSTANTIATE_TEST_SUITE_P(
    Of, WrongWiring,
    testing::Values(Wiring{"MirroredAxis", "-1 0 0 0 1 0 0 0 1", "mirrored"},
                    Wiring{"SwappedAxes", "0 1 0 1 0 0 0 0 1", "mirrored"},
                    Wiring{"TurnedSensor", "0 -1 0 1 0 0 0 0 1", "rotated by 90"},
                    Wiring{"OppositeSigns", "-1 0 0 0 -1 0 0 0 -1", "All signs are reversed"}),
    [](const testing::TestParamInfo<Wiring>& wiring) { return std::string(wiring.param.name); });

// The file gives each arm the address of the other arm.
TEST_F(Commissioning, ExchangedSensorsAreRefused) {
  SwitchOn({Left(), Right(), "left=net_ft:" + HostOf(kLeftSensor),
            "right=net_ft:" + HostOf(kRightSensor)});
  folder_.Change([](Machine* machine) {
    machine->left->sensor = {SensorMake::kNetFt, HostOf(kRightSensor), 1e6, 1e6};
    machine->right->sensor = {SensorMake::kNetFt, HostOf(kLeftSensor), 1e6, 1e6};
    for (std::optional<MachineArm>* arm : {&machine->left, &machine->right})
      (*arm)->arm.sensor.sample_rate = 1000;
  });
  Terminal terminal = Predictor({"calibrate", "push", "--arm", "left"});
  PushOne(&terminal);
  EXPECT_EQ(terminal.Wait(), kBadInput);
  EXPECT_NE(terminal.Screen().find("are swapped"), std::string::npos) << terminal.Screen();
  EXPECT_FALSE(IsPushTested(*folder_.machine().left));
}

}  // namespace
}  // namespace predictor
