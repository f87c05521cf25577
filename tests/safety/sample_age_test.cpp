// Tests the allowed age of a sample, which is safety.max_age or 2.5 periods of a slower device.
#include <gtest/gtest.h>

#include "safety/monitor.h"

namespace predictor {
namespace {

// Returns the monitor's verdict on one arm whose joint sample and wrench have these ages [s].
Status Judge(double arm_age, double sensor_age, const SamplePeriods& periods,
             const SafetySpec& safety = {}) {
  Monitor monitor(safety, RenderingSpec{}, {false, false}, 0.001, {periods, SamplePeriods{}});
  DeviceSample sample;
  ArmSample& arm = sample.arms[0];
  arm.present = true;
  arm.q = arm.v = JointVector::Zero(6);
  arm.arm_age = arm_age;
  arm.sensor_age = sensor_age;
  MonitorInput input;
  input.present = {true, false};
  input.sample = &sample;
  input.lower[0] = JointVector::Constant(6, -1);
  input.upper[0] = JointVector::Constant(6, 1);
  return monitor.Check(input);
}

TEST(SampleAge, MayBeMaxAgeForAFastDevice) {
  for (const double period : {0.0, 0.001, 0.002}) {
    EXPECT_TRUE(Judge(0.005, 0.005, {period, period}).ok()) << period;
    const Status status = Judge(0.0051, 0, {period, period});
    EXPECT_EQ(status.cause, StopCause::kStale) << period;
    EXPECT_DOUBLE_EQ(status.limit, 0.005);
  }
}

TEST(SampleAge, MayBeTwoAndAHalfPeriodsForASlowOne) {
  EXPECT_TRUE(Judge(0.0199, 0, {0.008, 0.001}).ok());
  const Status status = Judge(0.0201, 0, {0.008, 0.001});
  EXPECT_EQ(status.cause, StopCause::kStale);
  EXPECT_DOUBLE_EQ(status.value, 0.0201);
  EXPECT_DOUBLE_EQ(status.limit, 0.02);
}

TEST(SampleAge, OfArmAndSensorHaveLimitsOfTheirOwn) {
  EXPECT_EQ(Judge(0.001, 0.0199, {0.008, 0.001}).cause, StopCause::kStale);
  EXPECT_TRUE(Judge(0.001, 0.0199, {0.001, 0.008}).ok());
  // If two samples are too old, the monitor must report the sample that exceeds its limit by more.
  // Here, the sensor's sample exceeds its limit by 10 ms, and the arm's sample by 5 ms.
  EXPECT_DOUBLE_EQ(Judge(0.025, 0.015, {0.008, 0.001}).limit, 0.005);
}

// Silence must have the same effect in a scenario that tolerates old samples.
TEST(SampleAge, SilenceCutsPowerForAnyMaxAge) {
  for (const double max_age : {0.001, 0.005, 0.019, 0.021, 1.0}) {
    SafetySpec safety;
    safety.max_age = max_age;
    const Status late = Judge(0.0201, 0, {0.002, 0.002}, safety);
    EXPECT_EQ(late.cause, StopCause::kStale) << max_age;
    EXPECT_TRUE(late.power_off) << max_age;
    EXPECT_FALSE(Judge(0.0199, 0, {0.002, 0.002}, safety).power_off) << max_age;
  }
}

}  // namespace
}  // namespace predictor
