#include "core/suspend_watch.h"

#include <gtest/gtest.h>

#include <random>

namespace predictor {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

// Clocks that a thread reads three times in a row. The thread may be delayed between two readings.
// `first` is the time from the first reading to the second reading, and `second` is the time from
// the second reading to the third one.
class Clocks {
 public:
  std::int64_t Look(std::int64_t first, std::int64_t second) {
    const std::int64_t before = now_, boot = before + first + suspended_;
    now_ = before + first + second;
    return watch_.Look(before, boot, now_);
  }
  void Pass(std::int64_t time) { now_ += time; }
  void Suspend(std::int64_t time) { suspended_ += time; }

 private:
  SuspendWatch watch_;
  std::int64_t now_ = 77, suspended_ = 3'600'000 * kMillisecond;  // before the program started
};

TEST(SuspendWatch, TakesNoDelayForASuspend) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int64_t> delay(0, 2'000 * kMillisecond);
  Clocks clocks;
  for (int i = 0; i < 10'000; ++i) {
    EXPECT_EQ(clocks.Look(delay(random), delay(random)), 0) << i;
    clocks.Pass(delay(random));
  }
}

TEST(SuspendWatch, SeesEachSuspendOnce) {
  Clocks clocks;
  EXPECT_EQ(clocks.Look(30, 30), 0);
  for (const std::int64_t time : {50 * kMillisecond, 36'000'000 * kMillisecond}) {
    clocks.Suspend(time);
    EXPECT_NEAR(static_cast<double>(clocks.Look(30, 30)), static_cast<double>(time), 100);
    EXPECT_EQ(clocks.Look(30, 30), 0);
    clocks.Pass(kMillisecond);
    EXPECT_EQ(clocks.Look(30, 30), 0);
  }
}

// The measured time may be too short by the time between the readings, but never too long.
TEST(SuspendWatch, SeesASuspendThoughTheThreadIsHeldUp) {
  Clocks clocks;
  EXPECT_EQ(clocks.Look(30, 30), 0);
  clocks.Suspend(5'000 * kMillisecond);
  const std::int64_t seen = clocks.Look(kMillisecond, 800 * kMillisecond);
  EXPECT_GE(seen, 4'199 * kMillisecond);
  EXPECT_LE(seen, 5'000 * kMillisecond);
}

}  // namespace
}  // namespace predictor
