#include "devices/wire/device_clock.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace predictor {
namespace {

TEST(DeviceClock, MeasuresTheDelayBeyondTheQuickestPackage) {
  DeviceClock clock;
  EXPECT_GE(clock.Age(5), 1e9);
  std::uint64_t now = 7'000'000'000;
  double stamp = 1234;
  for (int i = 0; i < 1000; ++i) clock.Arrived(stamp += 0.002, now += 2'000'000);
  EXPECT_NEAR(clock.Age(now), 0, 1e-9);
  clock.Arrived(stamp += 0.002, now += 12'000'000);  // 10 ms late
  EXPECT_NEAR(clock.Age(now), 0.010, 1e-5);
  EXPECT_NEAR(clock.Age(now + 5'000'000), 0.015, 1e-5);
}

// The delay must not seem to grow, even with the worst drift of a quartz clock.
TEST(DeviceClock, ForgivesDrift) {
  for (const double drift : {-2e-4, 2e-4}) {
    DeviceClock clock;
    std::uint64_t now = 1'000'000'000;
    double stamp = 0;
    for (int i = 0; i < 500 * 600; ++i) {
      stamp += 0.002 * (1 + drift);
      clock.Arrived(stamp, now += 2'000'000);
      ASSERT_LT(clock.Age(now), 1e-5);
    }
  }
}

}  // namespace
}  // namespace predictor
