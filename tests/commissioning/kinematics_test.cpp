// The program must refuse an arm whose kinematics differ from the model's.
#include <gtest/gtest.h>

#include <numbers>

#include "commissioning/arm_checks.h"
#include "commissioning/station.h"
#include "core/random.h"
#include "devices/connect.h"
#include "devices/franka_rig.h"
#include "devices/ur_bench.h"
#include "models/arm_model.h"

namespace predictor::commissioning {
namespace {

constexpr const char* kRobots = "package://example-robot-data/robots/";

ArmSpec UrSpec(const std::string& urdf) {
  ArmSpec spec;
  spec.model = kRobots + ("ur_description/urdf/" + urdf);
  spec.end_effector = "tool0";
  spec.base.xyz = {0.3, -0.2, 0.1};
  spec.base.rpy = {0.2, -0.1, 0.7};
  return spec;
}

ArmSpec PandaSpec() {
  ArmSpec spec;
  spec.model = kRobots + std::string("panda_description/urdf/panda.urdf");
  spec.remove_links = {"panda_hand"};
  spec.end_effector = "panda_link8";
  spec.base.xyz = {0.3, -0.2, 0.1};
  return spec;
}

UrVector Anywhere(RandomStream* random) {
  UrVector q;
  for (double& angle : q) angle = std::numbers::pi * (2 * random->Uniform() - 1);
  return q;
}

DeviceFacts Reported(const UrGeometry& arm, const UrVector& q) {
  DeviceFacts facts;
  facts.flange = ReportedFlange{Eigen::Map<const Vector6>(q.data()), FlangeOf(arm, q), "tool0"};
  return facts;
}

std::string Refusal(const DeviceFacts& facts, const ArmSpec& spec) {
  return KinematicsRefusal(facts, spec, *LoadArmModel(spec, spec.base.X_RB(), {}, "arm"));
}

// Returns the data that an arm reports when the program connects at these joint angles.
DeviceFacts Connected(const FakeUrOptions& options, const UrVector& q,
                      const std::string& unknown = "") {
  UrBench bench(options);
  bench.mechanics.sample.q = Eigen::Map<const Vector6>(q.data());
  bench.fake.rtde().unknown.insert(unknown);
  bench.network.Pass(0.01);
  return bench.Connect().arm->facts();
}

// The fake uses the manufacturer's published parameters, but the model does not.
TEST(KinematicsRefusal, DistinguishesAllArmsOfUniversalRobots) {
  for (const auto& [urdf, own] :
       {std::pair{"ur5_robot.urdf", "ur5"}, {"ur10_robot.urdf", "ur10"}}) {
    const ArmSpec spec = UrSpec(urdf);
    const auto model = LoadArmModel(spec, spec.base.X_RB(), {}, "arm");
    RandomStream random(1, "joints");
    for (int i = 0; i < 300; ++i) {
      const UrVector q = Anywhere(&random);
      for (const UrGeometry& arm : kUrGeometries)
        ASSERT_EQ(KinematicsRefusal(Reported(arm, q), spec, *model).empty(),
                  arm.model == std::string(own))
            << arm.model << " as " << urdf;
    }
  }
}

TEST(KinematicsRefusal, ToleratesTheDeviationsOfACalibrationOnly) {
  const ArmSpec spec = UrSpec("ur5_robot.urdf");
  const UrVector q = {0.3, -1.2, 1.8, -2.2, -1.5, 0.4};
  for (const double beside : {0.99, 1.01}) {
    DeviceFacts moved = Reported(kUr5, q), turned = moved;
    moved.flange->X_BF.p.y() += beside * kFlangeSlack;
    EXPECT_EQ(Refusal(moved, spec).empty(), beside < 1);
    Quaternion& rotation = turned.flange->X_BF.q;
    rotation = RotationFromVector({0, beside * kFlangeRotation, 0}) * rotation;
    EXPECT_EQ(Refusal(turned, spec).empty(), beside < 1);
  }
}

TEST(KinematicsRefusal, OfAnotherBaseIgnoresHalfATurn) {
  const ArmSpec spec = UrSpec("ur5_robot.urdf");
  const UrVector q = {0.3, -1.2, 1.8, -2.2, -1.5, 0.4};
  for (const double turn : {0.0, 0.5, 1.0}) {  // in half turns
    DeviceFacts facts = Reported(kUr5, q);
    const Pose X = PoseFromXyzRpy(Vector3::Zero(), {0, 0, turn * std::numbers::pi});
    facts.flange->X_BF = X * facts.flange->X_BF;
    EXPECT_EQ(Refusal(facts, spec).empty(), turn != 0.5) << turn;
  }
}

TEST(KinematicsRefusal, OfInvalidNumbersAndOtherJoints) {
  const ArmSpec spec = UrSpec("ur5_robot.urdf");
  DeviceFacts facts;
  EXPECT_EQ(Refusal(facts, spec), "");  // the arm reports no flange pose
  facts = Reported(kUr5, {});
  facts.flange->X_BF.p.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(Refusal(facts, spec), "");
  EXPECT_NE(
      Refusal(Reported(kUr5, {}), PandaSpec()).find("The arm has 6 joints, but arm.model has 7"),
      std::string::npos);
}

TEST(KinematicsRefusal, OfAUrGoesByItsToolAndTheToolsOffset) {
  const ArmSpec spec = UrSpec("ur5_robot.urdf");
  const UrVector q = {0.3, -1.2, 1.8, -2.2, -1.5, 0.4};
  EXPECT_EQ(Refusal(Connected({}, q), spec), "");
  EXPECT_EQ(Refusal(Connected(Cb3(), q), spec), "");
  FakeUrOptions other;
  other.geometry = kUrGeometries[5];
  const std::string why = Refusal(Connected(other, q), spec);
  EXPECT_NE(why.find("Give a calibrated model of this arm"), std::string::npos) << why;
  EXPECT_EQ(why.find("tool centre point"), std::string::npos) << why;
  // If an arm does not report its tool offset, this offset must be zero.
  const std::string unknown = Refusal(Connected({}, q, "tcp_offset"), spec);
  EXPECT_NE(unknown.find("Set the tool centre point to zero at the pendant"), std::string::npos)
      << unknown;
  FakeUrOptions bare;
  bare.tool_offset = {};
  EXPECT_EQ(Refusal(Connected(bare, q, "tcp_offset"), spec), "");
}

TEST(KinematicsRefusal, IsEmptyForAUrWithoutPower) {
  for (const bool power : {true, false}) {
    UrBench bench;
    bench.network.Pass(0.01);
    if (!power) bench.fake.Do("power off");
    bench.Connect({.host = kUrHost, .listen = true});
    EXPECT_EQ(bench.arm->facts().flange.has_value(), power);
  }
}

TEST(KinematicsRefusal, OfAFrankaGoesByItsEndEffector) {
  for (const std::uint16_t version : {fci::kPandaVersion, fci::kResearch3Version})
    for (const double flange : {0.107, 0.107 + 1.1 * kFlangeSlack}) {
      FakeFrankaOptions options;
      options.version = version;
      options.flange = flange;
      FrankaRig rig(options);
      rig.Connect();
      EXPECT_EQ(Refusal(rig.arm->facts(), PandaSpec()).empty(), flange == 0.107) << version;
    }
}

// Every calibration must begin with this check.
TEST(Station, RefusesADifferentArm) {
  for (const bool own : {true, false}) {
    FakeUrOptions options;
    if (!own) options.geometry = kUrGeometries[5];
    UrBench bench(options);
    bench.network.Pass(0.01);
    MachineArm side;
    side.connection.host = kUrHost;
    side.arm = UrSpec("ur5_robot.urdf");
    side.arm.acceleration_limit = {20};
    auto arm = ConnectArm(side, ArmUse::kListen, &bench.network);
    std::string why;
    try {
      const Station station(0, side, std::move(arm), nullptr);
    } catch (const DeviceError& error) {
      why = error.what();
    }
    EXPECT_EQ(why.find("the arm reports its flange at") == std::string::npos, own) << why;
  }
}

}  // namespace
}  // namespace predictor::commissioning
