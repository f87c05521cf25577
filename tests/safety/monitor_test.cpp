#include "safety/monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "support/constants.h"

namespace predictor {
namespace {

// A tick of two running arms without any fault. Each test introduces one fault.
class MonitorTest : public testing::Test {
 protected:
  MonitorTest() : monitor_(safety_, rendering_, {true, true}, 0.001), random_(1, "sensor") {
    input_.present = {true, true};
    input_.running = true;
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      ArmSample& arm = sample_.arms[hand];
      arm.present = true;
      arm.q = JointVector::Constant(7, 0.5);
      arm.v = JointVector::Constant(7, 0.1);
      arm.arm_age = arm.sensor_age = 0.001;
      input_.lower[hand] = JointVector::Constant(7, -2);
      input_.upper[hand] = JointVector::Constant(7, 2);
      input_.wrench[hand].present = true;
      input_.wrench[hand].F_H_W << 3, -4, 10, 0.1, 0.2, -0.1;
      render_.v[hand] = JointVector::Constant(7, 0.1);
    }
    render_.link_distance = 0.5;
    input_.sample = &sample_;
    input_.world = &world_;
    input_.render = &render_;
  }

  // The samples of the next tick: fresh, with noise.
  void Refresh() {
    for (ArmSample& arm : sample_.arms) {
      ++arm.arm_sequence;
      ++arm.sensor_sequence;
      arm.F_S_raw[0] = 0.05 * random_.Normal();
    }
  }
  Status Check() {
    Refresh();
    return monitor_.Check(input_);
  }
  // Resets the monitor and passes it one tick without a fault.
  Status CheckAfterReset() {
    monitor_.Reset();
    return Check();
  }

  SafetySpec safety_;
  RenderingSpec rendering_;
  DeviceSample sample_;
  WorldState world_;
  RenderResult render_;
  MonitorInput input_;
  Monitor monitor_;
  RandomStream random_;
};

Quaternion QuaternionFromZ(double angle, double sign) {
  return Quaternion(sign * std::cos(angle / 2), 0, 0, sign * std::sin(angle / 2));
}

void ExpectStatus(const Status& status, StopCause cause, int hand, double value, double limit) {
  EXPECT_EQ(status.cause, cause) << Name(status.cause) << ", not " << Name(cause);
  EXPECT_EQ(status.hand, hand);
  EXPECT_NEAR(status.value, value, 1e-9);
  EXPECT_DOUBLE_EQ(status.limit, limit);
}

TEST_F(MonitorTest, NothingIsWrong) {
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

// The limit in RECOVERY is the usual limit, or a third of it above the smallest load since RECOVERY
// began, whichever is larger.
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
  // The smallest load counts, and loads within the usual limit are always allowed.
  EXPECT_TRUE(press(25, 1).ok());
  ExpectStatus(press(36, 1), StopCause::kForce, 1, 36, 35);
  EXPECT_TRUE(press(2, 1).ok());
  EXPECT_TRUE(press(29.9, 4.9).ok());
  ExpectStatus(press(30.1, 4.9), StopCause::kForce, 1, 30.1, 30);
  ExpectStatus(press(2, 5.1), StopCause::kTorque, 1, 5.1, 5);
  // Each RECOVERY begins afresh, and a NaN counts as too large.
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
  // Takes the short way round, whatever the quaternion's sign.
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

// Single missed deadlines that recur: more than ten within about a second.
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

// An arm that reports its joints every 8 ms shows larger changes from sample to sample.
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

// Vertical force of one hand that oscillates at 1 Hz and grows by 15 % per cycle, in addition to
// the task's force.
double Growing(int tick) {
  const double t = 0.001 * tick;
  return 10 + 0.3 * std::pow(1.15, t) * std::sin(2 * std::numbers::pi * t);
}

TEST_F(MonitorTest, OscillationOfEitherHand) {
  for (const std::size_t hand : {0U, 1U}) {
    Status status = CheckAfterReset();
    for (int k = 0; status.ok() && k < 30000; ++k) {
      input_.wrench[hand].F_H_W[2] = Growing(k);
      status = Check();
    }
    EXPECT_EQ(status.cause, StopCause::kOscillation);
    EXPECT_EQ(status.hand, static_cast<int>(hand));
    EXPECT_GE(status.value, 2);
    EXPECT_LE(status.value, 2.5);
    EXPECT_EQ(status.limit, 2);
    input_.wrench[hand].F_H_W[2] = 10;
  }
}

TEST_F(MonitorTest, OscillationBeginsWithTheRun) {
  Status status;
  int k = 0;
  input_.running = false;
  for (; status.ok() && k < 15000; ++k) {
    input_.wrench[0].F_H_W[2] = Growing(k);
    status = Check();
  }
  EXPECT_EQ(k, 15000);
  input_.running = true;
  const int start = k;
  for (; status.ok() && k < 30000; ++k) {
    input_.wrench[0].F_H_W[2] = Growing(k);
    status = Check();
  }
  EXPECT_EQ(status.cause, StopCause::kOscillation);
  EXPECT_GE(k - start, 4000);  // four cycles within this run
}

TEST_F(MonitorTest, OscillationOfAnEarlierRunIsForgotten) {
  const auto ticks_to_alarm = [&](int first) {
    for (int k = first; k < 60000; ++k) {
      input_.wrench[0].F_H_W[2] = Growing(k);
      if (!Check().ok()) return k - first;
    }
    return -1;
  };
  const int alarm = ticks_to_alarm(0);
  ASSERT_GT(alarm, 0);
  monitor_.Reset();
  for (int k = 0; k < alarm - 500; ++k) {
    input_.wrench[0].F_H_W[2] = Growing(k);
    ASSERT_TRUE(Check().ok());
  }
  input_.running = false;
  ASSERT_TRUE(Check().ok());
  input_.running = true;
  EXPECT_GE(ticks_to_alarm(alarm - 500), 4000);
}

// Vertical force of one hand that vibrates at 24 Hz and doubles in 0.2 s up to 3 N, in addition to
// the task's force.
double Vibrating(int tick) {
  const double t = 0.001 * tick;
  return 10 + std::min(3.0, 0.1 * std::exp2(5 * t)) * std::sin(2 * std::numbers::pi * 24 * t);
}

TEST_F(MonitorTest, VibrationOfEitherHand) {
  for (const std::size_t hand : {0U, 1U}) {
    Status status = CheckAfterReset();
    for (int k = 0; status.ok() && k < 3000; ++k) {
      input_.wrench[hand].F_H_W[2] = Vibrating(k);
      status = Check();
    }
    EXPECT_EQ(status.cause, StopCause::kOscillation);
    EXPECT_EQ(status.quantity, Quantity::kVibration);
    EXPECT_EQ(status.hand, static_cast<int>(hand));
    EXPECT_FALSE(status.power_off);
    EXPECT_GT(status.value, status.limit);
    EXPECT_LE(status.value, 3);
    input_.wrench[hand].F_H_W[2] = 10;
  }
}

TEST_F(MonitorTest, NeitherOscillationNorVibrationCountsWhereTheyAreSwitchedOff) {
  safety_.oscillation.enabled = false;
  monitor_ = Monitor(safety_, rendering_, {true, true}, 0.001);
  for (int k = 0; k < 20000; ++k) {
    input_.wrench[0].F_H_W[2] = Growing(k);
    input_.wrench[1].F_H_W[2] = Vibrating(k);
    ASSERT_TRUE(Check().ok()) << k;
  }
}

TEST_F(MonitorTest, VibrationOfAnEarlierRunIsForgotten) {
  const auto ticks_to_alarm = [&] {
    for (int k = 0; k < 3000; ++k) {
      input_.wrench[0].F_H_W[2] = 10 + 2.5 * std::sin(2 * std::numbers::pi * 24 * 0.001 * k);
      if (!Check().ok()) return k;
    }
    return -1;
  };
  const int alarm = ticks_to_alarm();
  ASSERT_GT(alarm, 40);
  // The run ends just before the alarm. The next run tolerates as much as the first.
  monitor_.Reset();
  for (int k = 0; k < alarm - 5; ++k) {
    input_.wrench[0].F_H_W[2] = 10 + 2.5 * std::sin(2 * std::numbers::pi * 24 * 0.001 * k);
    ASSERT_TRUE(Check().ok());
  }
  input_.running = false;
  ASSERT_TRUE(Check().ok());
  input_.running = true;
  EXPECT_GE(ticks_to_alarm(), alarm - 5);
}

// One fault each, in the order in which the faults take precedence.
struct Fault {
  StopCause cause;
  bool run_only;
  std::function<void(MonitorInput*, DeviceSample*, WorldState*, RenderResult*)> cause_it;
};

const std::vector<Fault>& Faults() {
  using In = MonitorInput*;
  using Sample = DeviceSample*;
  using World = WorldState*;
  using Render = RenderResult*;
  static const std::vector<Fault> faults = {
      {StopCause::kDevice, false,
       [](In in, Sample, World, Render) {
         in->device = {StopCause::kDevice, 1, 1, 2};
       }},
      {StopCause::kSensor, false,
       [](In in, Sample, World, Render) {
         in->sensing = {StopCause::kSensor, 1, 1, 2};
       }},
      {StopCause::kPhysics, false,
       [](In in, Sample, World, Render) {
         in->simulation = {StopCause::kPhysics, -1, 1, 2};
       }},
      {StopCause::kQp, false,
       [](In in, Sample, World, Render) {
         in->haptics = {StopCause::kQp, -1, 1, 2};
       }},
      {StopCause::kDevice, false, [](In, Sample s, World, Render) { s->arms[0].fault = true; }},
      {StopCause::kSensor, false,
       [](In, Sample s, World, Render) { s->arms[1].sensor_saturated = true; }},
      {StopCause::kForce, false,
       [](In in, Sample, World, Render) { in->wrench[0].F_H_W[0] = 100; }},
      {StopCause::kTorque, false,
       [](In in, Sample, World, Render) { in->wrench[0].F_H_W[3] = 100; }},
      {StopCause::kStale, false, [](In, Sample s, World, Render) { s->arms[0].arm_age = 1; }},
      {StopCause::kLinkDistance, false,
       [](In, Sample, World, Render r) { r->link_distance = 0.1; }},
      {StopCause::kJoint, false, [](In, Sample s, World, Render) { s->arms[0].q[0] = 3; }},
      {StopCause::kTracking, true,
       [](In in, Sample, World, Render) { in->virtual_[0].X_W.p[0] = 1; }},
      {StopCause::kCoupling, true, [](In, Sample, World w, Render) { w->coupling[0][0] = 900; }},
      {StopCause::kDeadline, false, [](In in, Sample, World, Render) { in->missed_deadlines = 9; }},
  };
  return faults;
}

TEST_F(MonitorTest, OfSeveralThingsTheFirstIsTold) {
  const auto& faults = Faults();
  for (const bool running : {true, false}) {
    for (std::size_t first = 0; first < faults.size(); ++first) {
      DeviceSample sample = sample_;
      WorldState world = world_;
      RenderResult render = render_;
      MonitorInput input = input_;
      input.sample = &sample;
      input.world = &world;
      input.render = &render;
      input.running = running;
      for (std::size_t i = first; i < faults.size(); ++i) {
        faults[i].cause_it(&input, &sample, &world, &render);
      }
      std::size_t expected = first;
      while (!running && faults[expected].run_only) ++expected;
      monitor_.Reset();
      EXPECT_EQ(monitor_.Check(input).cause, faults[expected].cause) << first << " " << running;
    }
  }
}

// The level of a stop also depends on faults of lower precedence than its cause.
TEST_F(MonitorTest, BehindWhatMayBeHeldTheMostSevereDecides) {
  for (JointVector& v : input_.velocity) v = JointVector::Constant(7, 2);
  EXPECT_TRUE(CheckAfterReset().ok());
  input_.device = {StopCause::kDevice};
  EXPECT_FALSE(Check().power_off);
  for (Status MonitorInput::*stage :
       {&MonitorInput::sensing, &MonitorInput::simulation, &MonitorInput::haptics}) {
    MonitorInput input = input_;
    input.*stage = {StopCause::kSensor, 1, 0, 0, Quantity::kNone, true};
    const Status status = monitor_.Check(input);
    EXPECT_EQ(status.cause, StopCause::kDevice);
    EXPECT_TRUE(status.power_off);
  }
  Refresh();
  sample_.arms[1].q[3] += 0.5;  // a jump
  const Status status = monitor_.Check(input_);
  EXPECT_EQ(status.cause, StopCause::kDevice);
  EXPECT_EQ(status.hand, -1);  // belongs to the stage, not to the jump
  EXPECT_TRUE(status.power_off);
}

// If no stop is to begin any more, a fault that forbids holding the arm is reported first.
TEST_F(MonitorTest, AtRestWhatTakesThePowerIsTold) {
  input_.running = false;
  input_.wrench[0].F_H_W[0] = 100;
  for (const bool follows : {true, false}) {
    const auto told = [&](const std::function<void()>& cause_it) {
      sample_.arms[1].arm_age = sample_.arms[1].sensor_age = 0;
      sample_.arms[1].sensor_saturated = false;
      cause_it();
      input_.follows = follows;
      monitor_.Reset();
      return monitor_.Check(input_);
    };
    const Status load = told([] {});
    EXPECT_EQ(load.cause, StopCause::kForce);
    EXPECT_FALSE(load.power_off);
    const Status silent = told([this] { sample_.arms[1].arm_age = 0.5; });
    EXPECT_TRUE(silent.power_off);
    EXPECT_EQ(silent.cause, follows ? StopCause::kForce : StopCause::kStale);
    const Status deaf = told([this] { sample_.arms[1].sensor_age = 0.5; });
    EXPECT_TRUE(deaf.power_off);
    EXPECT_EQ(deaf.cause, follows ? StopCause::kForce : StopCause::kStale);
    if (follows) continue;
    ExpectStatus(silent, StopCause::kStale, 1, 0.5, 0.02);
    EXPECT_EQ(silent.quantity, Quantity::kArmAge);
    ExpectStatus(deaf, StopCause::kStale, 1, 0.5, 0.02);
    EXPECT_EQ(deaf.quantity, Quantity::kSensorAge);
    const Status never = told([this] { sample_.arms[1].arm_age = HUGE_VAL; });
    ExpectStatus(never, StopCause::kStale, 1, 0, 0);
    EXPECT_EQ(never.quantity, Quantity::kNone);
    input_.wrench[0].F_H_W[0] = 0;
    const Status full = told([this] { sample_.arms[1].sensor_saturated = true; });
    ExpectStatus(full, StopCause::kSensor, 1, 0, 0);
    EXPECT_TRUE(full.power_off);
  }
}

// A fault that forbids holding the arm removes the power, whichever stage reports it and whatever
// other fault is present.
TEST_F(MonitorTest, WhatAStageMustNotHoldIsNotHeld) {
  for (Status MonitorInput::*stage : {&MonitorInput::device, &MonitorInput::sensing,
                                      &MonitorInput::simulation, &MonitorInput::haptics}) {
    MonitorInput input = input_;
    input.missed_deadlines = 9;
    EXPECT_FALSE(monitor_.Check(input).power_off);
    (input.*stage).cause = StopCause::kDevice;
    EXPECT_FALSE(monitor_.Check(input).power_off);
    (input.*stage).power_off = true;
    EXPECT_TRUE(monitor_.Check(input).power_off);
  }
}

TEST_F(MonitorTest, OutsideRunOnlySafetyCounts) {
  input_.running = false;
  for (const Fault& fault : Faults()) {
    DeviceSample sample = sample_;
    WorldState world = world_;
    RenderResult render = render_;
    MonitorInput input = input_;
    input.sample = &sample;
    input.world = &world;
    input.render = &render;
    fault.cause_it(&input, &sample, &world, &render);
    monitor_.Reset();
    EXPECT_EQ(monitor_.Check(input).cause, fault.run_only ? StopCause::kNone : fault.cause);
  }
  input_.haptics = {StopCause::kTracking, -1, 0.01, 0.002};
  EXPECT_TRUE(Check().ok());
  input_.running = true;
  EXPECT_EQ(Check().cause, StopCause::kTracking);
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
