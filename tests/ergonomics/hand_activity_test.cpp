#include "ergonomics/hand_activity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace predictor::ergonomics {
namespace {

// Cells of table 3 of Radwin et al. 2015, which an independent transcription of the paper contains:
// exertions per second, duty cycle [%], HAL to one decimal. The paper also rounds its constants.
TEST(HandActivity, HasTheCellsOfThePublishedTable) {
  struct Cell {
    double frequency, duty, level;
  };
  for (const Cell& cell : {Cell{0.125, 10, 0.8},
                           {0.25, 30, 2.4},
                           {0.25, 50, 2.8},
                           {0.5, 30, 4.0},
                           {0.5, 50, 4.5},
                           {0.5, 70, 4.9},
                           {0.5, 90, 5.2},
                           {1.0, 70, 6.7},
                           {1.0, 90, 7.1},
                           {1.5, 70, 7.4},
                           {1.5, 90, 7.8}})
    EXPECT_NEAR(HandActivityLevel(cell.frequency, cell.duty / 100), cell.level, 0.06)
        << cell.frequency << " " << cell.duty;
}

TEST(HandActivity, IsMonotoneAndStaysOnItsScale) {
  for (double duty = 0.02; duty <= 1; duty += 0.02) {
    double last = 0;
    for (const double frequency : {0.01, 0.125, 0.5, 1.0, 2.0, 10.0, 1000.0}) {
      const double level = HandActivityLevel(frequency, duty);
      EXPECT_GE(level, last);
      EXPECT_LE(level, 10);
      EXPECT_LE(level, HandActivityLevel(frequency, std::fmin(1, duty + 0.02)));
      last = level;
    }
  }
  EXPECT_EQ(HandActivityLevel(0, 0.5), 0);
  EXPECT_EQ(HandActivityLevel(0.5, 0), 0);
  EXPECT_EQ(HandActivityLevel(0.5, 0.005), 0);  // the equation is negative below 1 %
}

TEST(HandActivity, MarksWhatTheStudyDidNotCover) {
  EXPECT_TRUE(HandActivityWasStudied(0.5, 0.5));
  EXPECT_TRUE(HandActivityWasStudied(0.125, 1));
  EXPECT_FALSE(HandActivityWasStudied(0.1, 0.5));
  EXPECT_FALSE(HandActivityWasStudied(2, 0.5));
  EXPECT_FALSE(HandActivityWasStudied(0.5, 0.1));
}

// A textbook gives the limits of 2001 as lines: the peak force at the limit is 7.77 - 0.77 HAL, and
// at the action limit 5.55 - 0.55 HAL.
TEST(HandActivity, RatioAgreesWithThePublishedLines) {
  for (const double level : {0.0, 1.0, 3.0, 5.0}) {
    EXPECT_NEAR(HandActivityRatio(7.77 - 0.77 * level, level), 0.78, 0.01) << level;
    EXPECT_NEAR(HandActivityRatio(5.55 - 0.55 * level, level), 0.56, 0.01) << level;
  }
  EXPECT_EQ(HandActivityRatio(0, 10), 0);
  EXPECT_TRUE(std::isinf(HandActivityRatio(1, 10)));
  EXPECT_TRUE(std::isnan(HandActivityRatio(std::nan(""), 10)));
  EXPECT_TRUE(std::isnan(HandActivityRatio(std::nan(""), 5)));
}

}  // namespace
}  // namespace predictor::ergonomics
