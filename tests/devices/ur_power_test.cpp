// Tests the power-off of a UR through its dashboard, and what the driver reports about the power.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "devices/ur_arm_fixture.h"

namespace predictor {
namespace {

TEST_P(UrArmTest, CutsThePowerOnRequest) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(50, 0.1);
  EXPECT_FALSE(bench.reading.no_power_off);
  bench.arm->PowerOff(true);
  bench.Ticks(period() + 2, 0.1);
  EXPECT_EQ(bench.fake.controller().robot_mode, UrController::kPowerOff);
  EXPECT_NE(bench.arm->Trouble().find("not powered"), std::string::npos);
  bench.fake.controller().robot_mode = UrController::kRunning;  // a person switched it on
  for (int i = 0; i < 2000; ++i) {
    bench.arm->PowerOff(true);  // as in every tick of UNPOWERED; the request is not repeated
    bench.Tick(0, false);
    ASSERT_FALSE(bench.reading.keeps_power);
  }
  EXPECT_EQ(bench.fake.controller().robot_mode, UrController::kRunning);
}

// A stop requests power-off, but something prevents the robot from obeying.
TEST_P(UrArmTest, ReportsThatItKeepsItsPower) {
  for (const char* why : {"no dashboard", "local control", "drop dashboard"}) {
    UrBench bench(GetParam());
    const bool none = why == std::string("no dashboard");
    bench.Connect({.host = kUrHost, .dashboard_port = std::uint16_t(none ? 0 : 29999)});
    bench.Ticks(50, 0);
    EXPECT_TRUE(none || bench.fake.Do(why));
    bench.arm->PowerOff(true);
    bench.Ticks(990, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power) << why;  // it may still obey
    bench.Ticks(30, 0, false);
    EXPECT_TRUE(bench.reading.keeps_power) << why;
    EXPECT_EQ(bench.reading.no_power_off, why == std::string("drop dashboard"));
    for (const std::int32_t mode : {UrController::kPowerOff + 1, 5, 6}) {  // on, idle, backdrive
      bench.fake.controller().robot_mode = mode;
      bench.Ticks(20, 0, false);
      EXPECT_TRUE(bench.reading.keeps_power) << why << mode;
    }
    bench.fake.Do("power off");  // finally by hand
    bench.Ticks(20, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power) << why;
  }
}

TEST_P(UrArmTest, KeepsItsPowerWhereTheStopIsReset) {
  UrBench bench(GetParam());
  bench.Connect({.host = kUrHost, .dashboard_port = 0}).Ticks(50, 0);
  for (int again = 0; again < 2; ++again) {
    bench.arm->PowerOff(true);
    bench.Ticks(500, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power);
    bench.Ticks(530, 0, false);
    EXPECT_TRUE(bench.reading.keeps_power);
    bench.arm->PowerOff(false);
    bench.Ticks(20, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power);
  }
}

// The last known state is old, so the power may have changed.
TEST_P(UrArmTest, ReportsNoPowerWhileItIsSilent) {
  UrBench bench(GetParam());
  bench.Connect({.host = kUrHost, .dashboard_port = 0}).Ticks(50, 0);
  bench.arm->PowerOff(true);
  bench.Ticks(500, 0, false);
  bench.fake.Do("late 600");  // packets still arrive, but with this age [ms]
  bench.Ticks(1200, 0, false);
  EXPECT_GT(bench.reading.age, 0.5);
  EXPECT_FALSE(bench.reading.keeps_power);
}

TEST_P(UrArmTest, ReportsImmediatelyThatItsDashboardIsLost) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(50, 0.1);
  ASSERT_TRUE(bench.fake.Do("drop dashboard"));
  bench.Ticks(3, 0.1);
  EXPECT_TRUE(bench.reading.no_power_off);
  EXPECT_TRUE(bench.read.ok());  // the run continues
  bench.Ticks(50, 0.1);
  EXPECT_TRUE(bench.reading.no_power_off);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.1);
}

}  // namespace
}  // namespace predictor
