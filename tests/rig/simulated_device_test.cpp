#include "devices/simulated/simulated_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "core/error.h"
#include "rig/arms.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

DeviceCommand Still(RunState state, double run_time) {
  DeviceCommand command;
  command.state = state;
  command.run_time = run_time;
  command.v = {JointVector::Zero(7), JointVector::Zero(7)};
  return command;
}

TEST(SimulatedDevice, FollowsASineWithTheLagOfItsLoop) {
  Scenario scenario = ArmScenario(2);
  std::unique_ptr<Device> device = MakeSimulatedDevice(scenario, ArmStart(2));
  const double w = 2 * std::numbers::pi * 1.0, dt = 0.001;
  std::complex<double> phasor = 0;
  DeviceSample sample;
  for (int k = 0; k < 3000; ++k) {
    DeviceCommand command = Still(RunState::kAlign, 0);
    command.v[1][2] = 0.2 * std::cos(w * k * dt);
    ASSERT_TRUE(device->Write(command).ok());
    ASSERT_TRUE(device->Read(&sample).ok());
    const double t = (k + 1) * dt;
    if (k >= 1000)
      phasor += 2.0 / 2000 * sample.arms[1].v[2] * std::exp(std::complex<double>(0, -w * t));
  }
  // The loop is of second order with a pure delay. Half a tick is added to the delay because the
  // command is held.
  const VelocityLoopSpec& loop = scenario.device.right->loop;
  const double ratio = 1.0 / loop.bandwidth;
  const double lag =
      std::atan2(2 * loop.damping_ratio * ratio, 1 - ratio * ratio) / w + loop.delay + dt / 2;
  EXPECT_NEAR(-std::arg(phasor) / w, lag, 5e-5);
  EXPECT_NEAR(std::abs(phasor) / 0.2,
              1 / std::hypot(1 - ratio * ratio, 2 * loop.damping_ratio * ratio), 1e-3);
}

TEST(SimulatedDevice, ThePersonHoldsOnlyInRun) {
  Scenario scenario = ArmScenario(2);
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"})};
  SimulatedDevice device(scenario, ArmStart(2),
                         MakeVirtualOperator(scenario, HandInertia::kInWrench));
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(device.Write(Still(RunState::kArmed, 0)).ok());
  EXPECT_EQ(device.rig().true_operator().grip[0], 0);
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(device.Write(Still(RunState::kRun, 0.001 * k)).ok());
  EXPECT_NEAR(device.rig().true_operator().grip[0], 1, 1e-12);
  EXPECT_NEAR(device.rig().true_operator().grip[1], 1, 1e-12);
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(device.Write(Still(RunState::kStopping, 0.5)).ok());
  EXPECT_EQ(device.rig().true_operator().grip[0], 0);
}

TEST(SimulatedDevice, ReportsTheArmThatFails) {
  Scenario scenario = ArmScenario(2);
  SimulatedDevice device(scenario, ArmStart(2), nullptr);
  DeviceCommand command = Still(RunState::kRun, 0);
  command.v[1][0] = std::nan("");
  ASSERT_TRUE(device.Write(command).ok());
  DeviceSample sample;
  const Status status = device.Read(&sample);
  EXPECT_EQ(status.cause, StopCause::kDevice);
  EXPECT_EQ(status.hand, 1);
}

TEST(MakeSimulatedDevice, TakesOnlyScenariosForIt) {
  Scenario scenario = ArmScenario(1);
  scenario.device.type = "simulatd";
  try {
    MakeSimulatedDevice(scenario, ArmStart(1));
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("simulatd"), std::string::npos) << text;
    EXPECT_NE(text.find("must be simulated or real"), std::string::npos) << text;
  }
  scenario.device.type = "real";
  EXPECT_THROW(MakeSimulatedDevice(scenario, ArmStart(1)), InputError);
  scenario.device.type = "simulated";
  scenario.operator_.type = "ghost";
  EXPECT_THROW(MakeSimulatedDevice(scenario, ArmStart(1)), InputError);
}

TEST(SimulatedDevice, AllocatesNothingInARunAStopAndANewRun) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Scenario scenario = ArmScenario(2);
  scenario.operator_.script = {
      MakeActionSpec("grip", 0, {"duration=0.3"}), MakeActionSpec("move", 0.4, {"by=[0.05, 0, 0]"}),
      MakeActionSpec("push", 0.6, {"duration=0.1", "force=[0, 45, 0]"}),
      MakeActionSpec("circle", 1.5, {"cycles=1", "period=1"}), MakeActionSpec("release", 3.6)};
  std::unique_ptr<Device> device = MakeSimulatedDevice(scenario, ArmStart(2));
  DeviceCommand command = Still(RunState::kRun, 0);
  command.v[0].setConstant(0.05);
  DeviceCommand broken = command;
  broken.v[0][2] = std::nan("");
  DeviceSample sample;
  ASSERT_TRUE(device->Read(&sample).ok());  // sizes the vectors of the sample
  bool failed = false;
  test::AllocationGuard guard;
  for (int run = 0; run < 2; ++run) {
    for (int k = 0; k < 4500; ++k) {
      command.state = k < 4000 ? RunState::kRun : RunState::kStopping;
      command.run_time = 0.001 * std::min(k, 4000);
      failed |= !device->Write(k % 1000 == 999 ? broken : command).ok();
      failed |= !device->Read(&sample).ok();
    }
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_TRUE(failed);  // some of the commands were invalid
}

TEST(SimulatedDevice, DescribesItself) {
  Scenario scenario = ArmScenario(1);
  SimulatedDevice device(scenario, ArmStart(1), nullptr);
  EXPECT_EQ(device.Describe(),
            "Simulated rig: one arm, velocity loop 15 Hz, damping ratio 0.9, delay 4 ms, 1000 Hz");
}

}  // namespace
}  // namespace predictor
