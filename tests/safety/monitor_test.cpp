// Tests the limits of the monitor one by one.
#include "safety/monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "safety/monitor_fixture.h"
#include "support/constants.h"

namespace predictor {
namespace {

Quaternion QuaternionFromZ(double angle, double sign) {
  return Quaternion(sign * std::cos(angle / 2), 0, 0, sign * std::sin(angle / 2));
}

TEST_F(MonitorTest, NormalInputHasNoFault) {
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(Check().ok());
  input_.running = false;
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(Check().ok());
}

TEST_F(MonitorTest, ForceIsItsNorm) {
  input_.wrench[1].F_H_W.head<3>() = Vector3(10, 20, 20);
  EXPECT_TRUE(Check().ok());
  input_.wrench[1].F_H_W.head<3>() = 1.001 * Vector3(10, 20, 20);
  ExpectStatus(Check(), StopCause::kForce, 1, 30.03, 30);
}

TEST_F(MonitorTest, TorqueIsItsNorm) {
  input_.wrench[0].F_H_W.tail<3>() = Vector3(0, 3, -4);
  EXPECT_TRUE(Check().ok());
  input_.wrench[0].F_H_W.tail<3>() = Vector3(0, 3, -4.01);
  ExpectStatus(Check(), StopCause::kTorque, 0, std::hypot(3, 4.01), 5);
}

// In RECOVERY, the limit is the larger of two values: the usual limit, and the smallest load since
// RECOVERY began plus a third of the usual limit.
TEST_F(MonitorTest, RecoveryMayNotLoadAHandMore) {
  input_.running = input_.follows = false;
  const auto press = [&](double force, double torque) {
    input_.wrench[1].F_H_W << 0, force, 0, torque, 0, 0;
    return Check();
  };
  EXPECT_EQ(press(60, 0).cause, StopCause::kForce);
  input_.recovers = true;
  EXPECT_TRUE(press(60, 8).ok());
  EXPECT_TRUE(press(69.9, 8).ok());
  ExpectStatus(press(70.1, 8), StopCause::kForce, 1, 70.1, 70);
  EXPECT_TRUE(press(60, 8 + 1.6).ok());
  ExpectStatus(press(60, 8 + 1.7), StopCause::kTorque, 1, 9.7, 8 + 5.0 / 3);
  // The smallest load determines the limit, and loads within the usual limit are always allowed.
  EXPECT_TRUE(press(25, 1).ok());
  ExpectStatus(press(36, 1), StopCause::kForce, 1, 36, 35);
  EXPECT_TRUE(press(2, 1).ok());
  EXPECT_TRUE(press(29.9, 4.9).ok());
  ExpectStatus(press(30.1, 4.9), StopCause::kForce, 1, 30.1, 30);
  ExpectStatus(press(2, 5.1), StopCause::kTorque, 1, 5.1, 5);
  // Each RECOVERY must start without a smallest load, and a NaN must count as too large.
  input_.recovers = false;
  EXPECT_EQ(press(60, 0).cause, StopCause::kForce);
  input_.recovers = true;
  EXPECT_TRUE(press(60, 0).ok());
  EXPECT_EQ(press(kNan, 0).cause, StopCause::kSensor);
}

TEST_F(MonitorTest, NamesTheHandThatIsFurtherBeyond) {
  for (const int worse : {0, 1}) {
    input_.wrench[static_cast<std::size_t>(worse)].F_H_W.head<3>() = Vector3(45, 0, 0);
    input_.wrench[static_cast<std::size_t>(1 - worse)].F_H_W.head<3>() = Vector3(31, 0, 0);
    ExpectStatus(Check(), StopCause::kForce, worse, 45, 30);
  }
}

TEST_F(MonitorTest, AbsentSidesAreNotJudged) {
  input_.present = {true, false};
  sample_.arms[1] = ArmSample();
  input_.wrench[1].F_H_W.setConstant(kNan);
  input_.virtual_[1].X_W.p.setConstant(7);
  world_.coupling[1].setConstant(kInf);
  input_.lower[1].resize(0);
  EXPECT_TRUE(Check().ok());
}

TEST_F(MonitorTest, EveryNumberMustBeFinite) {
  ArmSample& arm = sample_.arms[1];
  struct Case {
    double* number;
    StopCause cause;
  };
  const std::vector<Case> cases = {
      {&arm.q[6], StopCause::kSensor},
      {&arm.v[0], StopCause::kSensor},
      {&arm.F_S_raw[5], StopCause::kSensor},
      {&arm.arm_age, StopCause::kSensor},
      {&arm.sensor_age, StopCause::kSensor},
      {&input_.wrench[1].F_H_W[2], StopCause::kSensor},
      {&input_.real[1].X_W.p[0], StopCause::kSensor},
      {&input_.real[1].X_W.q.coeffs()[3], StopCause::kSensor},
      {&input_.real[1].V_W[4], StopCause::kSensor},
      {&input_.virtual_[1].X_W.p[2], StopCause::kPhysics},
      {&input_.virtual_[1].X_W.q.coeffs()[0], StopCause::kPhysics},
      {&input_.virtual_[1].V_W[5], StopCause::kPhysics},
      {&world_.coupling[1][3], StopCause::kPhysics},
      {&render_.v[1][4], StopCause::kQp},
  };
  for (const bool running : {true, false}) {
    input_.running = running;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      for (const double bad : {kNan, kInf, -kInf}) {
        const double good = *cases[i].number;
        *cases[i].number = bad;
        const Status status = Check();
        *cases[i].number = good;
        EXPECT_EQ(status.cause, cases[i].cause) << i;
        EXPECT_EQ(status.hand, 1) << i;
        EXPECT_TRUE(std::isfinite(status.value) && std::isfinite(status.limit)) << i;
        EXPECT_TRUE(Check().ok()) << i;
      }
    }
  }
}

TEST_F(MonitorTest, SaturatedSensor) {
  sample_.arms[0].sensor_saturated = true;
  ExpectStatus(Check(), StopCause::kSensor, 0, 0, 0);
  EXPECT_TRUE(Check().power_off);
}

TEST_F(MonitorTest, FaultyMissingOrWrongArm) {
  sample_.arms[1].fault = true;
  ExpectStatus(Check(), StopCause::kDevice, 1, 0, 0);
  sample_.arms[1].fault = false;
  sample_.arms[1].present = false;
  ExpectStatus(Check(), StopCause::kDevice, 1, 0, 0);
  sample_.arms[1].present = true;
  sample_.arms[1].q.setZero(6);
  ExpectStatus(Check(), StopCause::kDevice, 1, 6, 7);
}

TEST_F(MonitorTest, OldSamples) {
  for (double* age : {&sample_.arms[0].arm_age, &sample_.arms[0].sensor_age}) {
    *age = 0.005;
    EXPECT_TRUE(Check().ok());
    *age = 0.0051;
    const Status status = Check();
    ExpectStatus(status, StopCause::kStale, 0, 0.0051, 0.005);
    EXPECT_EQ(status.quantity == Quantity::kArmAge, age == &sample_.arms[0].arm_age);
    EXPECT_EQ(status.quantity == Quantity::kSensorAge, age == &sample_.arms[0].sensor_age);
    *age = 0.001;
  }
}

TEST_F(MonitorTest, FrozenSensorIsFoundAtTheFiftiethReading) {
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(Check().ok());
  for (int reading = 1; reading <= 50; ++reading) {
    Refresh();
    sample_.arms[1].F_S_raw.setConstant(0.25);
    const Status status = monitor_.Check(input_);
    if (reading < 50) {
      ASSERT_TRUE(status.ok()) << reading;
    } else {
      ExpectStatus(status, StopCause::kStale, 1, 50, 49);
      EXPECT_EQ(status.quantity, Quantity::kCount);
    }
  }
  EXPECT_TRUE(Check().ok());
}

TEST_F(MonitorTest, RepeatedPacketsDoNotCountAsFrozenNorBreakTheCount) {
  int readings = 0;
  Status status;
  for (int k = 0; status.ok() && k < 1000; ++k) {
    const std::uint64_t sequence = sample_.arms[0].sensor_sequence;
    Refresh();
    sample_.arms[0].F_S_raw.setConstant(1);
    if (k % 4 != 0) sample_.arms[0].sensor_sequence = sequence;  // imitates a sensor at 250 Hz
    readings += k % 4 == 0;
    status = monitor_.Check(input_);
  }
  EXPECT_EQ(status.cause, StopCause::kStale);
  EXPECT_EQ(readings, 50);
}

TEST_F(MonitorTest, SequenceNumbersMayWrap) {
  for (ArmSample& arm : sample_.arms) arm.sensor_sequence = ~std::uint64_t{0} - 20;
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(Check().ok());
}

TEST_F(MonitorTest, SensorWithoutNoiseMayStandStill) {
  Monitor monitor(safety_, rendering_, {false, true}, 0.001);
  for (int k = 0; k < 200; ++k) {
    Refresh();
    sample_.arms[0].F_S_raw.setZero();
    ASSERT_TRUE(monitor.Check(input_).ok());
  }
}

TEST_F(MonitorTest, ElbowsNearerThanTheSecurityDistance) {
  render_.link_distance = 0.3 - 0.0009;
  EXPECT_TRUE(Check().ok());
  render_.link_distance = 0.3 - 0.0011;
  ExpectStatus(Check(), StopCause::kLinkDistance, -1, 0.2989, 0.3);
  render_.link_distance = kNan;
  ExpectStatus(Check(), StopCause::kLinkDistance, -1, 0, 0.3);
  render_.link_distance = kInf;  // no pairs
  EXPECT_TRUE(Check().ok());
  input_.render = nullptr;  // direct mode
  EXPECT_TRUE(Check().ok());
}

TEST_F(MonitorTest, JointBeyondItsLimits) {
  sample_.arms[0].q[3] = 2.0009;
  EXPECT_TRUE(Check().ok());
  sample_.arms[0].q[3] = 2.0011;
  ExpectStatus(Check(), StopCause::kJoint, 0, 2.0011, 2);
  sample_.arms[1].q[6] = -2.5;  // further beyond the limit
  ExpectStatus(Check(), StopCause::kJoint, 1, -2.5, -2);
}

TEST_F(MonitorTest, Tracking) {
  input_.virtual_[1].X_W.p = Vector3(0.03, 0.04, 0);
  EXPECT_TRUE(Check().ok());
  input_.virtual_[1].X_W.p = Vector3(0.03, 0.041, 0);
  ExpectStatus(Check(), StopCause::kTracking, 1, std::hypot(0.03, 0.041), 0.05);
  input_.virtual_[1].X_W.p.setZero();
  // Whatever the quaternion's sign is, the monitor must measure the shorter rotation.
  for (const double sign : {1.0, -1.0}) {
    input_.virtual_[0].X_W.q = QuaternionFromZ(0.3, sign);
    EXPECT_TRUE(Check().ok());
    input_.virtual_[0].X_W.q = QuaternionFromZ(0.4, sign);
    ExpectStatus(Check(), StopCause::kTracking, 0, 0.4, 0.35);
  }
}

TEST_F(MonitorTest, Coupling) {
  world_.coupling[0].head<3>() = Vector3(0, 0, -80);
  world_.coupling[1].tail<3>() = Vector3(9, 0, 12);
  EXPECT_TRUE(Check().ok());
  world_.coupling[1].tail<3>() *= 1.01;
  ExpectStatus(Check(), StopCause::kCoupling, 1, 15.15, 15);
  world_.coupling[0].head<3>() *= 1.01;
  ExpectStatus(Check(), StopCause::kCoupling, 0, 80.8, 80);
}

TEST_F(MonitorTest, MissedDeadlines) {
  input_.missed_deadlines = 2;
  EXPECT_TRUE(Check().ok());
  input_.missed_deadlines = 3;
  ExpectStatus(Check(), StopCause::kDeadline, -1, 3, 2);
}

// The loop misses single deadlines repeatedly. The loop misses more than ten deadlines within about
// a second.
TEST_F(MonitorTest, DeadlinesThatAreMissedNowAndThen) {
  for (const int period : {50, 200}) {
    Status status = CheckAfterReset();
    int k = 1;
    for (; status.ok() && k < 10'000; ++k) {
      input_.missed_deadlines = k % period == 0 ? 1 : 0;
      status = Check();
    }
    EXPECT_EQ(status.cause, period == 50 ? StopCause::kDeadline : StopCause::kNone) << k;
  }
}

// If an arm reports its joints every 8 ms, the joint angles change more from sample to sample.
TEST_F(MonitorTest, JointsThatJump) {
  for (JointVector& v : input_.velocity) v = JointVector::Constant(7, 2);
  for (const int period : {1, 8}) {
    const double most = 2.5 * 2 * 0.001 * period + 0.002;
    for (const double step : {0.9 * most, 1.1 * most}) {
      Status status = CheckAfterReset();
      for (int k = 1; k <= 8 * period && status.ok(); ++k) {
        Refresh();
        ArmSample& arm = sample_.arms[1];
        const bool fresh = k % period == 0;
        arm.arm_sequence -= fresh ? 0 : 1;
        arm.q[3] += fresh ? (k / period % 2 == 0 ? step : -step) : 0;
        status = monitor_.Check(input_);
      }
      EXPECT_EQ(status.cause, step > most ? StopCause::kDevice : StopCause::kNone) << step;
      EXPECT_EQ(status.power_off, step > most);
      sample_.arms[1].q[3] = 0.5;
    }
  }
}

TEST_F(MonitorTest, DirectModeHasNoArms) {
  input_.sample = nullptr;
  input_.render = nullptr;
  EXPECT_TRUE(Check().ok());
  input_.wrench[0].F_H_W[0] = 31;
  EXPECT_EQ(Check().cause, StopCause::kForce);
}

}  // namespace
}  // namespace predictor
