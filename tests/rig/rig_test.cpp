#include "rig/rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "rig/arms.h"
#include "rig/simulated_arm.h"

namespace predictor {
namespace {

// An operator that always exerts the force set by the test.
class Puppet final : public Operator {
 public:
  explicit Puppet(const Wrench& F) : F_(F) {}
  void Step(const OperatorInput&, OperatorOutput* output) noexcept override {
    output->F_H_W[0] = F_;
  }
  void Reset() noexcept override {}
  void Archive(StateArchive&) noexcept override {}

 private:
  Wrench F_;
};

DeviceCommand Command(const JointVector& left) {
  DeviceCommand command;
  command.v[0] = left;
  return command;
}

JointVector Wave(double t, double frequency, double amplitude) {
  JointVector v(7);
  for (int j = 0; j < 7; ++j) {
    v[j] = amplitude * std::sin(2 * std::numbers::pi * frequency * t + j) - amplitude * std::sin(j);
  }
  return v;
}

TEST(Rig, HandlesMoveAsTheirPosesSay) {
  Scenario scenario = ArmScenario(1);
  Rig rig(scenario, ArmStart(1), nullptr);
  std::vector<FrameMotion> motion;
  for (int k = 0; k < 400; ++k) {
    rig.Step(Command(Wave(k * 0.001, 1.5, 0.3)), 0.001);
    motion.push_back(rig.true_handles()[0]);
  }
  for (std::size_t k = 20; k + 1 < motion.size(); ++k) {
    const FrameMotion &before = motion[k - 1], &now = motion[k], &after = motion[k + 1];
    Twist V;
    V << (after.X_W.p - before.X_W.p) / 0.002, RotationError(after.X_W.q, before.X_W.q) / 0.002;
    ASSERT_LT((now.V_W - V).norm(), 3e-4) << k;
    ASSERT_LT((now.A_W - (after.V_W - before.V_W) / 0.002).norm(), 3e-2) << k;
  }
  EXPECT_GT(motion.back().A_W.norm(), 0.5);
}

TEST(Rig, SensorAtRestReadsWeightAndBias) {
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  scenario.rig.sensor_bias = {1, -2, 3, 0.1, -0.2, 0.3};
  Rig rig(scenario, ArmStart(1), nullptr);
  DeviceSample sample;
  rig.Read(&sample);
  const ArmSpec& arm = *scenario.device.left;
  // The rig provides H. S is computed from H by X_WS = X_WH X_HE X_ES.
  const Pose X_WS =
      rig.true_handles()[0].X_W * arm.handle.ToPose().Inverse() * arm.sensor.pose.ToPose();
  const Vector3 weight = X_WS.q.conjugate() * Vector3(0, 0, -arm.payload.mass * 9.81);
  Wrench expected;
  expected << weight + Vector3(1, -2, 3),
      arm.payload.center_of_mass.cross(weight) + Vector3(0.1, -0.2, 0.3);
  EXPECT_LT((sample.arms[0].F_S_raw - expected).norm(), 1e-9);
  EXPECT_FALSE(sample.arms[1].present);
}

TEST(Rig, SensorReadsTheHandsWrenchShiftedToIt) {
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  Wrench F_H_W;
  F_H_W << 3, -4, 5, 0.1, 0.2, -0.3;
  Rig held(scenario, ArmStart(1), std::make_unique<Puppet>(F_H_W));
  Rig free(scenario, ArmStart(1), nullptr);
  DeviceSample with, without;
  for (Rig* rig : {&held, &free}) rig->Step(Command(JointVector::Zero(7)), 0.001);
  held.Read(&with);
  free.Read(&without);
  const ArmSpec& arm = *scenario.device.left;
  const Pose X_WH = held.true_handles()[0].X_W;
  const Pose X_WS = X_WH * arm.handle.ToPose().Inverse() * arm.sensor.pose.ToPose();
  const Wrench difference = with.arms[0].F_S_raw - without.arms[0].F_S_raw;
  const Vector3 force = X_WS.q * Vector3(difference.head<3>());
  const Vector3 torque = X_WS.q * Vector3(difference.tail<3>());
  EXPECT_LT((force - F_H_W.head<3>()).norm(), 1e-9);
  // The total moment about H, including the moment of the force, must be the same.
  const Vector3 about_H = torque + (X_WS.p - X_WH.p).cross(force);
  EXPECT_LT((about_H - F_H_W.tail<3>()).norm(), 1e-9);
}

TEST(Rig, ComputationAddsToTheDelayAndTheTrueLoopReplacesTheNominalOne) {
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  scenario.rig.loop = VelocityLoopSpec{100, 0.9, 0.003};
  scenario.rig.computation_delay = 0.010;
  Rig rig(scenario, ArmStart(1), nullptr);
  VelocityLoop expected(*scenario.rig.loop, 0.013, 0.001, 2.0, 10.0);
  DeviceSample sample;
  for (int k = 0; k < 100; ++k) {
    rig.Step(Command(JointVector::Constant(7, 0.05)), 0.001);
    expected.Step(0.05);
    rig.Read(&sample);
    for (int j = 0; j < 7; ++j) ASSERT_NEAR(sample.arms[0].v[j], expected.v(), 1e-12);
    if (k < 13) {
      ASSERT_EQ(sample.arms[0].v.norm(), 0);
    }
  }
}

TEST(Rig, AnArmWithoutCommandsComesToRest) {
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  Rig rig(scenario, ArmStart(1), nullptr);
  for (int k = 0; k < 300; ++k) rig.Step(Command(JointVector::Constant(7, 0.3)), 0.001);
  DeviceSample sample;
  rig.Pass(0.019);
  rig.Read(&sample);
  EXPECT_NEAR(sample.arms[0].v[0], 0.3, 1e-6);  // the last command is still active
  double before = sample.arms[0].v[0];
  for (int k = 0; k < 200; ++k) {
    rig.Pass(0.001);
    rig.Read(&sample);
    ASSERT_LE(before - sample.arms[0].v[0], 10 * 0.001 + 1e-12);
    before = sample.arms[0].v[0];
  }
  EXPECT_NEAR(sample.arms[0].v.norm(), 0, 1e-6);
}

TEST(Rig, RefusesCommandsWithoutOneNumberPerJoint) {
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  Rig rig(scenario, ArmStart(1), nullptr);
  DeviceSample sample;
  JointVector bad = JointVector::Constant(7, 0.1);
  bad[3] = std::numeric_limits<double>::quiet_NaN();
  const JointVector short_one = JointVector::Zero(6);
  for (const JointVector& v : {bad, short_one}) {
    for (int k = 0; k < 300; ++k) rig.Step(Command(JointVector::Constant(7, 0.2)), 0.001);
    rig.Read(&sample);
    EXPECT_FALSE(sample.arms[0].fault);
    for (int k = 0; k < 300; ++k) rig.Step(Command(v), 0.001);
    rig.Read(&sample);
    EXPECT_TRUE(sample.arms[0].fault);
    EXPECT_TRUE(sample.arms[0].q.allFinite());
    // there was no valid command for 300 ms, so the arm rests
    EXPECT_NEAR(sample.arms[0].v.norm(), 0, 1e-5);
  }
  rig.Step(Command(JointVector()), 0.001);
  rig.Read(&sample);
  EXPECT_FALSE(sample.arms[0].fault);
}

TEST(Rig, EncodersAreQuantisedAndVelocitiesNoisy) {
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  scenario.rig.encoder_resolution = 1e-4;
  scenario.rig.velocity_noise = 1e-3;
  Rig rig(scenario, ArmStart(1), nullptr);
  DeviceSample sample, again;
  double squares = 0;
  const int n = 3000;
  for (int k = 0; k < n; ++k) {
    rig.Step(Command(JointVector::Zero(7)), 0.001);
    rig.Read(&sample);
    for (int j = 0; j < 7; ++j) ASSERT_NEAR(std::remainder(sample.arms[0].q[j], 1e-4), 0, 1e-12);
    squares += sample.arms[0].v.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / (7 * n)), 1e-3, 4e-3 / std::sqrt(2.0 * 7 * n));
  rig.Read(&again);  // a second reading returns the same sample
  EXPECT_EQ(again.arms[0].v, sample.arms[0].v);
  EXPECT_EQ(again.arms[0].arm_sequence, sample.arms[0].arm_sequence);
}

TEST(Rig, TicksOfTwoMillisecondsAreTwoSteps) {
  Scenario slow = ArmScenario(1), fast = ArmScenario(1);
  slow.rate = 500;
  Rig one(slow, ArmStart(1), nullptr), two(fast, ArmStart(1), nullptr);
  DeviceSample a, b;
  for (int k = 0; k < 200; ++k) {
    const DeviceCommand command = Command(Wave(0.002 * k, 2, 0.2));
    one.Step(command, 0.002);
    two.Step(command, 0.001);
    two.Step(command, 0.001);
    one.Read(&a);
    two.Read(&b);
    ASSERT_EQ(a.arms[0].q, b.arms[0].q);
    ASSERT_EQ(a.arms[0].F_S_raw, b.arms[0].F_S_raw);
  }
}

TEST(Rig, RepeatsItselfForASeedAndDiffersForAnother) {
  Scenario scenario = ArmScenario(2);
  const auto run = [](const Scenario& s) {
    Rig rig(s, ArmStart(2), MakeVirtualOperator(s, HandInertia::kInWrench));
    DeviceCommand command = Command(JointVector::Zero(7));
    command.v[1] = command.v[0];
    DeviceSample sample;
    for (int k = 0; k < 100; ++k) rig.Step(command, 0.001);
    rig.Read(&sample);
    return sample;
  };
  const DeviceSample first = run(scenario), second = run(scenario);
  EXPECT_EQ(first.arms[0].F_S_raw, second.arms[0].F_S_raw);
  EXPECT_EQ(first.arms[1].v, second.arms[1].v);
  scenario.seed = 77;
  const DeviceSample other = run(scenario);
  EXPECT_NE(first.arms[0].F_S_raw, other.arms[0].F_S_raw);
  EXPECT_NE(first.arms[1].v, other.arms[1].v);
}

TEST(Rig, RefusesWhatItCannotSimulate) {
  Scenario scenario = ArmScenario(1);
  scenario.rig.computation_delay = 0.5;
  EXPECT_THROW(Rig(scenario, ArmStart(1), nullptr), InputError);
  scenario = ArmScenario(1);
  std::array<JointVector, kHands> start = ArmStart(1);
  start[0].conservativeResize(6);
  EXPECT_THROW(Rig(scenario, start, nullptr), InputError);
  scenario.device.left->acceleration_limit = {1, 2, 3};
  EXPECT_THROW(Rig(scenario, ArmStart(1), nullptr), InputError);
}

}  // namespace
}  // namespace predictor
