#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "evaluation/statistics_same_kind.h"

namespace predictor {
namespace {

using Repeats = std::vector<std::vector<double>>;

// A wave of its own size and phase, and noise: neighbouring samples hang together, as of people.
Repeats Waves(std::size_t count, double size, std::mt19937_64* random) {
  std::normal_distribution<double> normal;
  Repeats repeats(count);
  for (auto& one : repeats) {
    const double amplitude = size + 0.2 * normal(*random), phase = 0.1 * normal(*random);
    for (int k = 0; k < 40; ++k)
      one.push_back(amplitude * std::sin(0.157 * k + phase) + 0.05 * normal(*random));
  }
  return repeats;
}

int ToldApart(double size, int trials, std::size_t count) {
  std::mt19937_64 random(7);
  int told = 0;
  for (int k = 0; k < trials; ++k) {
    const Repeats a = Waves(count, 1, &random), b = Waves(count, size, &random);
    told += TestSameKind(a, b, 199).told_apart();
  }
  return told;
}

TEST(SameKind, OneInTwentyOfEqualKindsIsToldApart) {
  // Binomial, 400 times 5 %: 20 ± 4.4; beyond three and a half deviations once in two thousand.
  const int told = ToldApart(1, 400, 17);
  EXPECT_GE(told, 5);
  EXPECT_LE(told, 35);
}

TEST(SameKind, UnequalKindsAreToldApart) {
  // Their sizes are 1.5 deviations apart: Student's test would tell 98 of 100 apart.
  EXPECT_GE(ToldApart(1.3, 100, 17), 90);
  // Kinds of one mean that spread unlike differ as well.
  std::mt19937_64 random(3);
  Repeats narrow(17, {0.0}), wide = narrow;
  for (std::size_t k = 0; k < 17; ++k) {
    narrow[k][0] = 0.1 * (static_cast<double>(k) - 8);
    wide[k][0] = 10 * narrow[k][0];
  }
  EXPECT_TRUE(TestSameKind(narrow, wide).told_apart());
}

// All 20 ways to deal six numbers: |x − y| is the rms difference of series of one sample. The sets
// are the lowest three and the highest three, which no other way but the exchanged one puts as far
// apart.
TEST(SameKind, PIsThatOfGoingThroughAllWays) {
  const Repeats low = {{1}, {2}, {3}}, high = {{11}, {12}, {13}};
  const SameKindTest test = TestSameKind(low, high);
  EXPECT_DOUBLE_EQ(test.distance, 10 - 4.0 / 3);  // within: 1, 1 and 2
  EXPECT_DOUBLE_EQ(test.least_p, 2.0 / 20);
  EXPECT_FALSE(test.can_tell());
  // Standard error of 9999 draws: 0.003.
  EXPECT_NEAR(test.p, 0.1, 0.012);
  EXPECT_FALSE(TestSameKind(low, low).told_apart());
}

TEST(SameKind, SaysFromHowManyRepeatsItCanTell) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {2u, 3u, 4u, 17u})
    EXPECT_EQ(TestSameKind(Waves(n, 1, &random), Waves(n, 9, &random)).can_tell(), n >= 4) << n;
  EXPECT_TRUE(TestSameKind(Waves(4, 1, &random), Waves(4, 9, &random)).told_apart());
}

}  // namespace
}  // namespace predictor
