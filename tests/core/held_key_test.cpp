// Tests whether the program recognises a held key from letters alone.
#include "core/held_key.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace predictor {
namespace {

constexpr double kStep = 0.001;    // interval between updates [s]
constexpr double kRepeat = 0.033;  // repeat interval of a terminal [s]

// A terminal in virtual time.
class HeldKeyTest : public testing::Test {
 protected:
  // Types a letter after each gap [s].
  void Letters(const std::vector<double>& gaps, char letter = 's') {
    for (const double gap : gaps) {
      Pass(gap - kStep);
      now_ += gap > 0 ? kStep : 0;
      Note(key_.Update(letter, now_));
    }
  }
  void Pass(double time) {
    for (long n = std::lround(time / kStep); n > 0; --n) {
      now_ += kStep;
      Note(key_.Update(0, now_));
    }
  }
  // Types the letters of a held key: one letter and, after a pause, the repeated letters.
  void Hold(int repeats = 5) {
    Letters({1, 0.5});
    Letters(std::vector<double>(static_cast<std::size_t>(repeats), kRepeat));
  }
  int Count(KeySign sign) const { return static_cast<int>(std::ranges::count(signs_, sign)); }

  HeldKey key_{'s'};
  double now_ = 1;
  std::vector<KeySign> signs_;

 private:
  void Note(KeySign sign) {
    if (sign != KeySign::kNone) signs_.push_back(sign);
  }
};

TEST_F(HeldKeyTest, IsHeldFromTheSecondLetterUntilItIsSilent) {
  Letters({1});
  EXPECT_FALSE(key_.held());
  Letters({0.5});
  EXPECT_FALSE(key_.held());
  Pass(HeldKey::kTogether + kStep);
  EXPECT_TRUE(key_.held());
  Letters({kRepeat, 0.095, kRepeat});
  EXPECT_TRUE(key_.held());
  Pass(0.095);
  EXPECT_TRUE(key_.held());
  Pass(0.010);
  EXPECT_FALSE(key_.held());
  EXPECT_EQ(signs_, (std::vector{KeySign::kTouched, KeySign::kHeld, KeySign::kContinues,
                                 KeySign::kContinues, KeySign::kContinues}));
}

// If no letter arrives for too long, the key counts as released. After that, the key counts as held
// only after two letters, not after one.
TEST_F(HeldKeyTest, MustBeHeldAgainAfterSilence) {
  Hold();
  Letters({0.15});
  Pass(0.05);
  EXPECT_FALSE(key_.held());
  Letters({kRepeat});
  Pass(0.02);
  EXPECT_TRUE(key_.held());
}

// If no letter arrives for too long, the key counts as released, even if nothing calls Update
// meanwhile.
TEST_F(HeldKeyTest, IsReleasedByUnobservedSilence) {
  Hold();
  now_ += 0.5;
  EXPECT_EQ(key_.Update('s', now_), KeySign::kNone);
  EXPECT_FALSE(key_.held());
}

TEST_F(HeldKeyTest, AnotherKeyReleases) {
  Hold();
  EXPECT_TRUE(key_.held());
  Letters({0.01}, 'x');
  EXPECT_FALSE(key_.held());
  Letters({0.01});
  Pass(0.02);
  EXPECT_FALSE(key_.held());
}

TEST_F(HeldKeyTest, TwoTouchesFarApartAreNotHolding) {
  Letters({1, 0.9, 0.9});
  Pass(0.9);
  EXPECT_EQ(Count(KeySign::kTouched), 3);
  EXPECT_EQ(Count(KeySign::kNotHeld), 3);
  EXPECT_EQ(Count(KeySign::kHeld), 0);
}

TEST_F(HeldKeyTest, TwoTouchesWithoutAnUpdateInBetweenAreNotHoldingEither) {
  Letters({1});
  Pass(0.02);
  now_ += 0.9;
  EXPECT_EQ(key_.Update('s', now_), KeySign::kNone);
  Pass(0.02);
  EXPECT_FALSE(key_.held());
  EXPECT_EQ(Count(KeySign::kTouched), 2);
}

// The letters of half a second arrive together after the person has released the key.
TEST_F(HeldKeyTest, ABacklogDoesNotCountAsHolding) {
  for (int letters = 2; letters < 20; ++letters) {
    signs_.clear();
    Letters({1});
    for (int i = 1; i < letters; ++i) Letters({0});
    Pass(1);
    EXPECT_EQ(signs_, std::vector{KeySign::kLate}) << letters;
  }
}

// A backlog must not count as holding if it arrives in pieces or lacks the pauses of a held key.
TEST_F(HeldKeyTest, ABacklogInPiecesDoesNotCountAsHoldingEither) {
  for (const std::vector<double>& gaps : {std::vector<double>{1, 0.05, 0, 0, 0},
                                          {1, 0, 0, 0.05},
                                          {1, 0.05, 0.001, 0.001},
                                          {1, 0, 0.05, 0, 0.05, 0},
                                          {1, 0.05, 0.009},
                                          {1, 0.2, 0, 0, 0.05},
                                          {1, 0.003, 0.003, 0.003, 0.003, 0.003}}) {
    Letters(gaps);
    Pass(1);
    EXPECT_EQ(Count(KeySign::kHeld), 0);
  }
}

// The person still holds the key. Letters that arrive in time after a backlog must count.
TEST_F(HeldKeyTest, AfterABacklogLiveLettersHold) {
  Letters({1, 0, 0, 0});
  Letters({kRepeat, kRepeat, kRepeat});
  EXPECT_TRUE(key_.held());
}

TEST_F(HeldKeyTest, ALetterThatWasNotJudgedInTimeBeginsNothing) {
  Letters({1, 0.5});
  now_ += 0.5;
  EXPECT_EQ(key_.Update(0, now_), KeySign::kNone);
  EXPECT_FALSE(key_.held());
}

// A busy computer sometimes delivers two letters together.
TEST_F(HeldKeyTest, PairsOfLettersDoNotRelease) {
  Hold();
  const int before = Count(KeySign::kContinues);
  for (int i = 0; i < 10; ++i) Letters({2 * kRepeat, 0});
  EXPECT_TRUE(key_.held());
  EXPECT_EQ(Count(KeySign::kContinues) - before, 10);  // one sign for each pair
}

// Letters that arrive together count as a single letter, so a burst counts as holding only until
// the time-out.
TEST_F(HeldKeyTest, ABacklogDoesNotKeepHolding) {
  Hold();
  for (int i = 0; i < 60; ++i) Letters({0.002});
  EXPECT_FALSE(key_.held());
}

// A jammed key must not count as touched again, even if its letters were queued for a long time.
TEST_F(HeldKeyTest, IsTouchedOncePerPress) {
  Hold(100);
  EXPECT_EQ(Count(KeySign::kTouched), 1);
  Letters({0.79});
  Pass(0.05);
  EXPECT_EQ(Count(KeySign::kTouched), 1);
  Letters({2, 0, 0, 0, 0});
  Letters(std::vector<double>(50, kRepeat));
  EXPECT_EQ(Count(KeySign::kTouched), 1);
  Letters({0.81});
  Pass(0.05);
  EXPECT_EQ(Count(KeySign::kTouched), 2);
}

}  // namespace
}  // namespace predictor
