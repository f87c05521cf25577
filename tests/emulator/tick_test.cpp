// Tests that the tick is repeatable and does not allocate memory.
#include <gtest/gtest.h>

#include "runs.h"
#include "support/allocation_guard.h"
#include "support/soak.h"

namespace predictor {
namespace {

TEST(Repeatability, SameSeedSameBytesOtherSeedOtherBytes) {
  const std::vector<std::string> set = {"duration=6"};
  const std::string once = SummaryJson(RunScenario("box_9kg", set).summary, false);
  EXPECT_EQ(once, SummaryJson(RunScenario("box_9kg", set).summary, false));
  EXPECT_NE(once, SummaryJson(RunScenario("box_9kg", {"duration=6", "seed=2"}).summary, false));
}

// No tick may allocate memory while the run starts, runs, stops, is held, is reset and is repeated.
TEST(Tick, TakesNothingFromTheHeapSoak) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  for (const char* name : {"box_9kg", "single_arm", "dual_ur5"}) {
    Emulator emulator(LoadTestScenario(name));
    const long ticks = Count(10'000, 1'000'000);
    test::AllocationGuard guard;
    for (long k = 0; k < ticks; ++k) {
      emulator.Tick();
      AutoStart(&emulator);
      if (k % 4000 == 3999) emulator.Request(RunEvent::kStopRequested);
      if (emulator.state() == RunState::kHeld) emulator.Request(RunEvent::kReset);
    }
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

TEST(Tick, RecordsWhatHappened) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  std::uint64_t expected = 0;
  bool ran = false;
  Simulate(&emulator, 1.0, [&](const TickRecord& record) {
    EXPECT_EQ(record.tick, ++expected);
    if (record.state != RunState::kRun) return;
    ran = true;
    EXPECT_EQ(record.cobot_dof, 7);
    EXPECT_EQ(record.hands[0].arm_dof, 7);
    EXPECT_GT(record.energy, -1e6);
    EXPECT_LT(record.kkt_residual, 1e-6);
  });
  EXPECT_TRUE(ran);
}

}  // namespace
}  // namespace predictor
