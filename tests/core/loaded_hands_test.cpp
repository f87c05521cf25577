#include "core/loaded_hands.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/message_catalogue.h"
#include "core/words.h"

namespace predictor {
namespace {

class LoadedHandsTest : public testing::Test {
 protected:
  // Simulates `milliseconds` in the state `state` with a force at the left handle [N]. Returns the
  // messages.
  std::vector<std::string> Pass(int milliseconds, RunState state, double force,
                                bool fault = false) {
    std::vector<std::string> reported;
    for (int i = 0; i < milliseconds; ++i) {
      TickRecord record{};
      record.tick = ++tick_;
      record.state = state;
      record.hands[0].present = true;
      record.hands[0].wrench[1] = -force;
      record.hands[1].present = fault;
      record.hands[1].arm_fault = fault;
      record.hands[1].wrench[0] = fault ? 0 : 50;
      for (const std::string& words : hands_.See(record)) reported.push_back(words);
    }
    return reported;
  }

  LoadedHands hands_{5, 1000};
  std::uint64_t tick_ = 0;
};

TEST_F(LoadedHandsTest, AreReportedOnceWhileTheyAreLoaded) {
  EXPECT_TRUE(Pass(2000, RunState::kRun, 20).empty());
  EXPECT_TRUE(Pass(499, RunState::kHeld, 20).empty());
  const auto reported = Pass(2, RunState::kHeld, 20);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_EQ(
      reported[0],
      Message("danger.loaded",
              {{"side", "left"},
               {"force", "20"},
               {"caught", Message("danger.caught_recover", {{"hold", HowToHold('r', false)}})}}));
  EXPECT_TRUE(Pass(60'000, RunState::kHeld, 20).empty());
}

TEST_F(LoadedHandsTest, AreReportedWithTheKeyOfThisRig) {
  hands_ = {5, 1000, true};
  const auto reported = Pass(501, RunState::kHeld, 20);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_NE(reported[0].find(HowToHold('r', true)), std::string::npos) << reported[0];
}

// One hand is trapped only after a while. Later, it is free and then trapped again.
TEST_F(LoadedHandsTest, AreWatchedAsLongAsTheArmsStand) {
  EXPECT_TRUE(Pass(10'000, RunState::kHeld, 4.9).empty());
  EXPECT_EQ(Pass(600, RunState::kHeld, 30).size(), 1U);
  EXPECT_TRUE(Pass(400, RunState::kHeld, 1).empty());
  EXPECT_TRUE(Pass(600, RunState::kHeld, 30).empty());  // the release was too short
  EXPECT_TRUE(Pass(600, RunState::kHeld, 1).empty());
  EXPECT_TRUE(Pass(400, RunState::kHeld, 30).empty());  // only a touch
  EXPECT_TRUE(Pass(100, RunState::kHeld, 1).empty());
  EXPECT_EQ(Pass(600, RunState::kHeld, 30).size(), 1U);
  // Recovery moved the handle away from the hand, but not far enough.
  EXPECT_TRUE(Pass(600, RunState::kRecovery, 30).empty());
  EXPECT_EQ(Pass(600, RunState::kHeld, 30).size(), 1U);
}

TEST_F(LoadedHandsTest, OfARobotWithoutPowerHaveOtherAdvice) {
  const auto reported = Pass(600, RunState::kUnpowered, 12);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_EQ(reported[0].find(HowToHold('r', false)), std::string::npos) << reported[0];
  EXPECT_TRUE(reported[0].ends_with(Message("danger.caught_free"))) << reported[0];
  EXPECT_TRUE(Pass(2000, RunState::kUnpowered, std::numeric_limits<double>::quiet_NaN()).empty());
}

// RECOVERY would stop immediately, because an arm with a fault accepts commands again only through
// a new driver.
TEST_F(LoadedHandsTest, AreNotFreedByRecoveryWhereAnArmIsAtFault) {
  const auto reported = Pass(600, RunState::kHeld, 12, true);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_EQ(reported[0].find(HowToHold('r', false)), std::string::npos) << reported[0];
  EXPECT_TRUE(reported[0].ends_with(Message("danger.caught_free"))) << reported[0];
}

}  // namespace
}  // namespace predictor
