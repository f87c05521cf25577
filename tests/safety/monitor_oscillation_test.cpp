// Tests when the monitor passes the hands' forces to the detectors of oscillation and vibration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "safety/monitor_fixture.h"

namespace predictor {
namespace {

// Returns the vertical force of one hand. The force consists of the task's force and an oscillation
// at 1 Hz that grows by 15 % per cycle.
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

// Returns the vertical force of one hand. The force consists of the task's force and a vibration at
// 24 Hz that doubles in 0.2 s up to 3 N.
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

TEST_F(MonitorTest, OscillationAndVibrationDoNotCountIfSwitchedOff) {
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
  // The run ends just before the alarm. In the next run, the detector must tolerate the vibration
  // for as long as in the first run.
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

}  // namespace
}  // namespace predictor
