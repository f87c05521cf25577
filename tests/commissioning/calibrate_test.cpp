// Tests measurements in which a person guides or pushes an arm of the rig. measure_loop_test.cpp
// covers those in which the arm moves by itself.
#include "commissioning/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/rig_bench.h"
#include "core/error.h"

namespace predictor::commissioning {
namespace {

std::vector<JointVector> Postures(const JointVector& start, int count) {
  std::vector<JointVector> all;
  const double tilts[][3] = {{0, 0, 0},    {1.0, 0, 0},   {-1.0, 0, 0},   {0, 1.0, 0},
                             {0, -1.0, 0}, {0.8, 0.9, 0}, {-0.7, 0.8, 1}, {0.5, -0.9, -1}};
  for (int i = 0; i < count; ++i) {
    JointVector q = start;
    for (int j = 0; j < 3; ++j) q[4 + j] += tilts[i % 8][j];
    all.push_back(q);
  }
  return all;
}

TEST(MeasureHandle, OfAGuidedArmFindsTheHandleOfTheRig) {
  Bench bench;
  Leader leader(&bench.hand);
  const auto postures = Postures(bench.q(), 8);
  std::size_t next = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    if (last.find("press Enter to take the pose") == std::string::npos) return 0;
    if (next == postures.size()) return 'd';
    if (!leader.Lead(postures[next])) return 0;
    ++next;
    return kEnter;
  });
  Session session(&bench.time, &person, {&bench.station});
  const HandleCalibration found = MeasureHandle(&session, bench.station);
  const HandlePayloadSpec& truth = bench.scenario.device.left->payload;
  EXPECT_EQ(found.poses, 8);
  EXPECT_NEAR(found.mass.value, truth.mass, 0.01 * truth.mass) << person.All();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.center_of_mass[i].value, truth.center_of_mass[static_cast<Eigen::Index>(i)],
                0.001);
    EXPECT_NEAR(found.bias[i].value, bench.scenario.rig.sensor_bias[i], 0.05);
  }
  const std::string text = HandleText(found, truth);
  EXPECT_NE(text.find("mass"), std::string::npos);
}

TEST(MeasureHandle, ReportsTheErrorAndContinues) {
  Bench bench;
  Leader leader(&bench.hand);
  const auto postures = Postures(bench.q(), 8);
  std::size_t next = 0;
  int presses = 0;  // presses of Enter; the handle is touched during the first
  int ends = 0;     // the first `d` comes too early
  ScriptedPerson person([&](const std::string& last) -> char {
    const double t = 1e-9 * static_cast<double>(bench.time.Now());
    bench.hand.touch[0] = presses == 1 ? 3 * std::sin(10 * t) : 0;
    if (last.find("press Enter to take the pose") == std::string::npos) return 0;
    if (next == 2 && ends == 0) return ++ends, 'd';
    if (next == 4) return kGiveUp;
    if (presses == 1) presses = 2;
    if (!leader.Lead(postures[next])) return 0;
    next += presses++ == 0 ? 0 : 1;
    return kEnter;
  });
  Session session(&bench.time, &person, {&bench.station});
  EXPECT_THROW(MeasureHandle(&session, bench.station), InputError);  // the person gave up
  EXPECT_NE(person.All().find("Take your hands off the handle"), std::string::npos) << person.All();
  EXPECT_NE(person.All().find("too few"), std::string::npos) << person.All();
}

TEST(Station, KeepsReadingAGuidedArmButNotASilentOne) {
  Bench bench;
  ScriptedPerson person([](const std::string&) -> char { return 0; });
  Session session(&bench.time, &person, {&bench.station});
  bench.hand.trouble = "it is being guided by hand";
  for (int k = 0; k < 100; ++k) session.Step();
  EXPECT_THROW(session.Step(&bench.station, [] { return JointVector::Zero(7); }), DeviceError);
  bench.hand.silent = true;
  EXPECT_THROW(
      {
        for (int k = 0; k < 1000; ++k) session.Step();
      },
      DeviceError);
}

TEST(Station, RefusesAModelOfAnotherArm) {
  Bench bench;
  MachineArm other = MachineArmOf(bench.scenario);
  other.arm.model = "package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf";
  other.arm.remove_links.clear();
  other.arm.end_effector = "tool0";
  EXPECT_THROW(Station(0, other, std::make_unique<RigDriver>(&bench.hand), nullptr), InputError);
  EXPECT_THROW(Station(0, MachineArmOf(bench.scenario),
                       std::make_unique<RigDriver>(&bench.hand, false), nullptr),
               DeviceError);
}

TEST(MeasureBases, OfTwoGuidedArmsFindsTheBaseOfOne) {
  VirtualTime time;
  const Scenario first = ArmScenario(1);
  Scenario second = ArmScenario(1);
  second.device.left->base.xyz = {1.1, 0.05, 0.02};  // facing the first arm
  second.device.left->base.rpy = {0.01, -0.02, 3.0};
  RigHand hand_a(first, &time, ArmStart(1)[0]), hand_b(second, &time, ArmStart(1)[0]);
  // The machine file has a wrong base pose for the second arm.
  MachineArm nominal = MachineArmOf(second);
  nominal.arm.base = {{1.0, 0, 0}, {0, 0, M_PI}};
  Station a(0, MachineArmOf(first), std::make_unique<RigDriver>(&hand_a), nullptr);
  Station b(1, nominal, std::make_unique<RigDriver>(&hand_b), nullptr);
  const Vector3 tip(0.01, 0.02, 0.15);
  const auto joints = [&](const Scenario& scenario, const Vector3& point) {
    const ArmSpec& spec = *scenario.device.left;
    const auto model = RobotModel::Load({spec.model, {}, spec.remove_links, spec.base.X_RB()});
    const Quaternion down = RotationFromVector({M_PI, 0, 0});
    JointVector q = ArmStart(1)[0];
    EXPECT_TRUE(SolveInverseKinematics(*model, model->Frame(spec.end_effector, {tip, {1, 0, 0, 0}}),
                                       {point, down}, q, 20, &q));
    return q;
  };
  const std::vector<Vector3> points = {
      {0.45, 0.15, 0.2}, {0.6, 0.35, 0.2}, {0.5, 0.3, 0.45}, {0.65, 0.1, 0.35}};
  std::size_t done = 0;
  Leader lead_a(&hand_a), lead_b(&hand_b);
  ScriptedPerson person([&](const std::string& last) -> char {
    if (last.find("Touch point") == std::string::npos) return 0;
    const bool by_b = last.find("right") != std::string::npos;
    const std::size_t index = by_b ? done - points.size() : done;
    if (index == points.size() || (!by_b && done == points.size())) {
      return done == points.size() ? 'd' : static_cast<char>(0);
    }
    static JointVector goal;
    static std::size_t planned = 99;
    if (planned != done) {
      goal = joints(by_b ? second : first, points[index]);
      planned = done;
    }
    if (!(by_b ? lead_b : lead_a).Lead(goal)) return 0;
    ++done;
    return kEnter;
  });
  Session session(&time, &person, {&a, &b});
  const BaseCalibration found = MeasureBases(&session, a, b, tip);
  const Pose truth = first.device.left->base.X_RB().Inverse() * second.device.left->base.X_RB();
  // The guiding hand stops within 0.2 mrad of the goal, so the tip is less than a millimetre away
  // from it.
  EXPECT_LT(PoseError(found.X_AB, truth).head<3>().norm(), 0.004) << person.All();
  EXPECT_LT(PoseError(found.X_AB, truth).tail<3>().norm(), 0.006);
  EXPECT_LT(found.residual, 0.001);
}

// Without --tip, the program must ask which part makes contact and must not guess it.
TEST(MeasureBases, WithoutATipAsksWhetherTheEndEffectorTouches) {
  Bench bench;
  const Station other(1, MachineArmOf(bench.scenario), std::make_unique<RigDriver>(&bench.hand),
                      nullptr);
  for (const char answer : {'n', 'y'}) {
    ScriptedPerson person([&](const std::string& last) -> char {
      if (last.find("No --tip was given") != std::string::npos) return answer;
      return last.find("Touch point 1") != std::string::npos ? kGiveUp : static_cast<char>(0);
    });
    Session session(&bench.time, &person, {&bench.station});
    std::string why;
    try {
      MeasureBases(&session, bench.station, other, std::nullopt);
    } catch (const InputError& error) {
      why = error.what();
    }
    EXPECT_NE(why.find(answer == 'n' ? "Start again with --tip X Y Z" : "Cancelled"),
              std::string::npos)
        << why;
    EXPECT_NE(person.All().find("of the left arm is " + bench.scenario.arm(0).end_effector),
              std::string::npos)
        << person.All();
  }
}

// A person pushes as instructed. In the machine file, the sensor is rotated by `turned` [rad] about
// the axes of the world. Returns the refusal.
std::string RefusalOfPushes(const Vector3& turned, std::string* reported = nullptr) {
  const Scenario scenario = ArmScenario(1);
  Bench bench(scenario);
  bench.station.Watch();
  const Quaternion q_WE = bench.station.EndEffectorPose().q;
  MachineArm nominal = MachineArmOf(scenario);
  PoseSpec& pose = nominal.arm.sensor.pose;
  pose.rpy = RpyOf(q_WE.conjugate() * RotationFromVector(turned) * q_WE * pose.ToPose().q);
  Station station(0, nominal, std::make_unique<RigDriver>(&bench.hand), nullptr);
  int axis = -1;
  double since = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    const Pose X_WS = bench.station.EndEffectorPose() * scenario.device.left->sensor.pose.ToPose();
    since += Session::kStep;
    if (const auto at = last.find("along +"); at != std::string::npos && axis != last[at + 7]) {
      axis = last[at + 7];
      since = 0;
    }
    const bool pushes = axis >= 0 && since > 0.3 && since < 1;
    const Vector3 F_W = pushes ? Vector3(12 * Vector3::Unit(axis - 'x')) : Vector3::Zero();
    bench.hand.touch.head<3>() = X_WS.q.conjugate() * F_W;
    if (since > 20) return kGiveUp;
    return last.find("Take your hands off") != std::string::npos ? kEnter : static_cast<char>(0);
  });
  Session session(&bench.time, &person, {&station, &bench.station});
  try {
    TestPushes(&session, station, nullptr);
    if (reported) *reported = person.All();
    return "";
  } catch (const InputError& error) {
    if (reported) *reported = person.All();
    return error.what();
  }
}

TEST(TestPushes, PassesThroughTheEstimatorAndRefusesATurnedSensor) {
  EXPECT_EQ(RefusalOfPushes({0, 0, 0}), "");
  const std::string turned = RefusalOfPushes({0, 0, M_PI});
  EXPECT_NE(turned.find("rotated by 180°"), std::string::npos) << turned;
  EXPECT_NE(RefusalOfPushes({M_PI / 2, 0, 0}).find("reads"), std::string::npos);
}

TEST(TestPushes, ReportsAWrongPushBeforeTheNextOne) {
  std::string reported;
  EXPECT_EQ(RefusalOfPushes({0, 0, 0}, &reported), "");
  EXPECT_EQ(reported.find("DIFFERS FROM THE PUSH"), std::string::npos) << reported;
  EXPECT_NE(RefusalOfPushes({0, 0, M_PI}, &reported), "");
  const auto x = reported.find("DIFFERS FROM THE PUSH. The push along +x reads -x: mirrored.");
  const auto y = reported.find("DIFFERS FROM THE PUSH. The push along +y reads -y: mirrored.");
  ASSERT_NE(x, std::string::npos) << reported;
  ASSERT_NE(y, std::string::npos) << reported;
  EXPECT_LT(x, reported.find("handle along +y"));
  EXPECT_LT(y, reported.find("handle along +z"));
  EXPECT_EQ(reported.find("The push along +z"), std::string::npos)
      << reported;  // the sensor read this
                    // push correctly
}

}  // namespace
}  // namespace predictor::commissioning
