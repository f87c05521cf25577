#include "watchdog/watchdog.h"

#include <gtest/gtest.h>

namespace predictor::watchdog {
namespace {

constexpr std::uint64_t kMillisecond = 1'000'000;

class WatchdogTest : public testing::Test {
 protected:
  // Looks one millisecond later. `ticked` states whether the loop has ticked.
  bool Look(bool ticked, RunState state = RunState::kRun) {
    ticks_ += ticked;
    return watchdog_.Look(ticks_, state, now_ += kMillisecond);
  }

  Watchdog watchdog_;
  std::uint64_t ticks_ = 5, now_ = 77 * kMillisecond;
};

TEST_F(WatchdogTest, DoesNotDisturbALoopThatTicks) {
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(Look(i % 9 == 0)) << i;  // 9 ms at the longest
}

TEST_F(WatchdogTest, ActsOnceAfterTenMilliseconds) {
  EXPECT_FALSE(Look(true));
  for (int i = 1; i < 10; ++i) EXPECT_FALSE(Look(false)) << i;
  EXPECT_TRUE(Look(false));
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(Look(false)) << i;
}

TEST_F(WatchdogTest, ActsAgainWhenTheLoopHangsAgain) {
  EXPECT_FALSE(Look(true));
  for (int round = 0; round < 3; ++round) {
    int barks = 0;
    for (int i = 0; i < 30; ++i) barks += Look(false);
    EXPECT_EQ(barks, 1);
    EXPECT_FALSE(Look(true));
  }
}

TEST_F(WatchdogTest, ActsOnlyWhenArmsMayMove) {
  for (int s = 0; s < kRunStates; ++s) {
    const auto state = static_cast<RunState>(s);
    Look(true, state);
    int barks = 0;
    for (int i = 0; i < 30; ++i) barks += Look(false, state);
    const bool moves = state == RunState::kAlign || state == RunState::kRun ||
                       state == RunState::kStopping || state == RunState::kRecovery;
    EXPECT_EQ(barks, moves ? 1 : 0) << Name(state);
  }
}

}  // namespace
}  // namespace predictor::watchdog
