// Tests which of several faults the monitor reports, and which faults remove the power.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "safety/monitor_fixture.h"

namespace predictor {
namespace {

// The faults are listed in the order in which they take precedence.
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

TEST_F(MonitorTest, OfSeveralFaultsTheFirstIsReported) {
  const auto& faults = Faults();
  for (const bool running : {true, false}) {
    for (std::size_t first = 0; first < faults.size(); ++first) {
      const Status status = CheckChanged([&](MonitorInput* input, auto*... others) {
        input->running = running;
        for (std::size_t i = first; i < faults.size(); ++i) faults[i].cause_it(input, others...);
      });
      std::size_t expected = first;
      while (!running && faults[expected].run_only) ++expected;
      EXPECT_EQ(status.cause, faults[expected].cause) << first << " " << running;
    }
  }
}

// The level of a stop must also depend on faults of lower precedence than its cause.
TEST_F(MonitorTest, AfterAFaultThatAllowsHoldingTheMostSevereDecides) {
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

// If no further stop can begin, the monitor must report a fault that forbids holding the arm before
// all other faults.
TEST_F(MonitorTest, AtRestTheReasonForPowerOffIsReported) {
  input_.running = false;
  input_.wrench[0].F_H_W[0] = 100;
  for (const bool follows : {true, false}) {
    const auto reported = [&](const std::function<void()>& cause_it) {
      sample_.arms[1].arm_age = sample_.arms[1].sensor_age = 0;
      sample_.arms[1].sensor_saturated = false;
      cause_it();
      input_.follows = follows;
      monitor_.Reset();
      return monitor_.Check(input_);
    };
    const Status load = reported([] {});
    EXPECT_EQ(load.cause, StopCause::kForce);
    EXPECT_FALSE(load.power_off);
    const Status silent = reported([this] { sample_.arms[1].arm_age = 0.5; });
    EXPECT_TRUE(silent.power_off);
    EXPECT_EQ(silent.cause, follows ? StopCause::kForce : StopCause::kStale);
    const Status deaf = reported([this] { sample_.arms[1].sensor_age = 0.5; });
    EXPECT_TRUE(deaf.power_off);
    EXPECT_EQ(deaf.cause, follows ? StopCause::kForce : StopCause::kStale);
    if (follows) continue;
    ExpectStatus(silent, StopCause::kStale, 1, 0.5, 0.02);
    EXPECT_EQ(silent.quantity, Quantity::kArmAge);
    ExpectStatus(deaf, StopCause::kStale, 1, 0.5, 0.02);
    EXPECT_EQ(deaf.quantity, Quantity::kSensorAge);
    const Status never = reported([this] { sample_.arms[1].arm_age = HUGE_VAL; });
    ExpectStatus(never, StopCause::kStale, 1, 0, 0);
    EXPECT_EQ(never.quantity, Quantity::kNone);
    input_.wrench[0].F_H_W[0] = 0;
    const Status full = reported([this] { sample_.arms[1].sensor_saturated = true; });
    ExpectStatus(full, StopCause::kSensor, 1, 0, 0);
    EXPECT_TRUE(full.power_off);
  }
}

// If a fault forbids holding the arm, it must remove the power, regardless of the stage that
// reports the fault and of any other faults.
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
  for (const Fault& fault : Faults())
    EXPECT_EQ(CheckChanged(fault.cause_it).cause, fault.run_only ? StopCause::kNone : fault.cause);
  input_.haptics = {StopCause::kTracking, -1, 0.01, 0.002};
  EXPECT_TRUE(Check().ok());
  input_.running = true;
  EXPECT_EQ(Check().cause, StopCause::kTracking);
}

}  // namespace
}  // namespace predictor
