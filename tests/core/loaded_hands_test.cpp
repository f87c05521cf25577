#include "core/loaded_hands.h"

#include <gtest/gtest.h>

#include <limits>

namespace predictor {
namespace {

class LoadedHandsTest : public testing::Test {
 protected:
  // Lets so many milliseconds pass in a state, a force at the left handle: what is told meanwhile.
  std::vector<std::string> Pass(int milliseconds, RunState state, double force,
                                bool fault = false) {
    std::vector<std::string> told;
    for (int i = 0; i < milliseconds; ++i) {
      TickRecord record{};
      record.tick = ++tick_;
      record.state = state;
      record.hands[0].present = true;
      record.hands[0].wrench[1] = -force;
      record.hands[1].present = fault;
      record.hands[1].arm_fault = fault;
      record.hands[1].wrench[0] = fault ? 0 : 50;
      for (const std::string& words : hands_.See(record)) told.push_back(words);
    }
    return told;
  }

  LoadedHands hands_{5, 1000};
  std::uint64_t tick_ = 0;
};

TEST_F(LoadedHandsTest, AreToldOnceWhileTheyAreLoaded) {
  EXPECT_TRUE(Pass(2000, RunState::kRun, 20).empty());
  EXPECT_TRUE(Pass(499, RunState::kHeld, 20).empty());
  const auto told = Pass(2, RunState::kHeld, 20);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0],
            "Something presses on the left handle with 20 N. Let go of it; if a hand is caught, "
            "hold r: the handle then goes where it is pressed to.");
  EXPECT_TRUE(Pass(60'000, RunState::kHeld, 20).empty());
}

TEST_F(LoadedHandsTest, AreToldWhatToHoldAtThisRig) {
  hands_ = {5, 1000, true};
  const auto told = Pass(501, RunState::kHeld, 20);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("hold the enabling device and touch r: the handle"), std::string::npos);
}

// A hand that is caught later, and one that was free and is caught again.
TEST_F(LoadedHandsTest, AreWatchedAsLongAsTheArmsStand) {
  EXPECT_TRUE(Pass(10'000, RunState::kHeld, 4.9).empty());
  EXPECT_EQ(Pass(600, RunState::kHeld, 30).size(), 1U);
  EXPECT_TRUE(Pass(400, RunState::kHeld, 1).empty());
  EXPECT_TRUE(Pass(600, RunState::kHeld, 30).empty());  // it had not let go for good
  EXPECT_TRUE(Pass(600, RunState::kHeld, 1).empty());
  EXPECT_TRUE(Pass(400, RunState::kHeld, 30).empty());  // a touch
  EXPECT_TRUE(Pass(100, RunState::kHeld, 1).empty());
  EXPECT_EQ(Pass(600, RunState::kHeld, 30).size(), 1U);
  // Recovery led away from it, and not far enough.
  EXPECT_TRUE(Pass(600, RunState::kRecovery, 30).empty());
  EXPECT_EQ(Pass(600, RunState::kHeld, 30).size(), 1U);
}

TEST_F(LoadedHandsTest, OfARobotWithoutPowerHaveOtherAdvice) {
  const auto told = Pass(600, RunState::kUnpowered, 12);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].find("hold r"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("the robot's own means"), std::string::npos) << told[0];
  EXPECT_TRUE(Pass(2000, RunState::kUnpowered, std::numeric_limits<double>::quiet_NaN()).empty());
}

// RECOVERY would stop at once: the arm's driver takes it up again when it is made anew only.
TEST_F(LoadedHandsTest, AreNotFreedByRecoveryWhereAnArmIsAtFault) {
  const auto told = Pass(600, RunState::kHeld, 12, true);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].find("hold r"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("the robot's own means"), std::string::npos) << told[0];
}

}  // namespace
}  // namespace predictor
