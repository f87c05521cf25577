// Tests that the settings of an arm in the machine file reach its driver.
#include "devices/connect.h"

#include <gtest/gtest.h>

#include "devices/franka_rig.h"
#include "devices/ur_bench.h"
#include "fakes/far_rig.h"
#include "fakes/kinds.h"
#include "fakes/note_loops.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

TEST(ConnectArm, CollisionThresholdsAreSetOnAFrankaThatIsMoved) {
  for (const ArmUse use : {ArmUse::kMove, ArmUse::kListen}) {
    FrankaRig rig;
    MachineArm side;
    side.connection.make = ArmMake::kFranka;
    side.connection.host = FrankaRig::kHost;
    side.connection.collision.emplace();
    side.connection.collision->force = 30;
    side.connection.collision->torque = 7;
    side.connection.collision->joint_torque = 20;
    const std::unique_ptr<Arm> arm = ConnectArm(side, use, &rig.network);
    EXPECT_EQ(rig.fake.collision_force(), use == ArmUse::kMove ? 30 : 0);
    EXPECT_NE(arm->facts().remarks.at(0).find("30 N or 7 N·m"), std::string::npos)
        << arm->facts().remarks.at(0);
    EXPECT_NE(arm->facts().remarks.at(0).find("20 N·m at a joint"), std::string::npos);
  }
}

TEST(ConnectArm, AListenerSendsNoProgram) {
  UrBench bench;
  MachineArm side;
  side.connection.host = kUrHost;
  side.arm.acceleration_limit = {20};
  const std::unique_ptr<Arm> arm = ConnectArm(side, ArmUse::kListen, &bench.network);
  const JointVector v = JointVector::Constant(kUrJoints, 0.1);
  ArmReading reading;
  for (int tick = 0; tick < 50; ++tick) {
    (void)arm->Read(&reading);
    (void)arm->Write(v, true);
    bench.network.Pass(0.001);
  }
  EXPECT_TRUE(bench.mechanics.command.isZero(0));
}

// Fake arms of one manufacturer for both hands of a scenario, and their machine file.
struct TwoArms {
  TwoArms(const char* fake, ArmMake make, const Scenario& scenario, FarRig* rig) {
    network->SetWorld([rig] { rig->Step(); });
    for (int hand = 0; hand < kHands; ++hand) {
      MachineArm side;
      side.connection.make = make;
      side.connection.host = "192.0.2.1" + std::to_string(hand);
      side.arm = scenario.arm(hand);
      std::unique_ptr<FakeDevice>& arm = arms[static_cast<std::size_t>(hand)];
      arm = MakeFake(fake, {});
      network->Add(side.connection.host, arm.get(), rig->Hang(hand));
      (hand == 0 ? machine.left : machine.right) = side;
    }
  }

  std::array<std::unique_ptr<FakeDevice>, kHands> arms;
  std::unique_ptr<MemoryNetwork> network = std::make_unique<MemoryNetwork>();
  Machine machine;
};

// An arm with a lower sample rate than in the machine file would appear to lose samples.
TEST(ConnectMachine, AnArmOfAnotherRateIsRefused) {
  Scenario scenario = LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml");
  FarRig rig(scenario);
  for (const double rate : {500.0, 1000.0}) {
    TwoArms arms("ur", ArmMake::kUr, scenario, &rig);
    arms.machine.left->arm.sample_rate = arms.machine.right->arm.sample_rate = rate;
    std::string refused;
    try {
      ConnectMachine(arms.machine, &scenario, std::move(arms.network));
    } catch (const DeviceError& error) {
      refused = error.what();
    }
    EXPECT_EQ(refused.find("500 samples per second") != std::string::npos, rate > 500) << refused;
  }
}

// If the driver of a Franka limited only one joint, the handle would leave its path.
TEST(ConnectMachine, AScenarioGetsTheLimitsOfAFrankasDriver) {
  Scenario scenario = LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/box_9kg.yaml");
  FarRig rig(scenario);
  TwoArms arms("franka", ArmMake::kFranka, scenario, &rig);
  scenario.device.left->acceleration_limit = {10};
  scenario.device.right->acceleration_limit = {12, 12, 12, 12, 12, 12, 3};
  scenario.device.right->velocity_limit = {9, 9, 9, 9, 9, 9, 0.5};
  const auto device = ConnectMachine(arms.machine, &scenario, std::move(arms.network));
  for (int hand = 0; hand < kHands; ++hand) {
    const DeviceFacts& facts = *device->arm_facts(hand);
    const ArmSpec& arm = scenario.arm(hand);
    ASSERT_EQ(arm.acceleration_limit.size(), 7U);
    ASSERT_EQ(arm.velocity_limit.size(), 7U);
    for (std::size_t i = 0; i < 7; ++i) {
      const bool own = hand == 1 && i == 6;
      EXPECT_EQ(arm.acceleration_limit[i], own ? 3 : facts.acceleration[i]) << hand << i;
      EXPECT_EQ(arm.velocity_limit[i], own ? 0.5 : facts.velocity[i]) << hand << i;
    }
  }
}

}  // namespace
}  // namespace predictor
