#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "evaluation/statistics_same_kind.h"

namespace predictor {
namespace {

using Repeats = std::vector<std::vector<double>>;

// Each series is a wave with a random size and phase, plus noise. Neighbouring samples are
// correlated, as they are for people.
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

int CountDistinguished(double size, int trials, std::size_t count) {
  std::mt19937_64 random(7);
  int distinguished = 0;
  for (int k = 0; k < trials; ++k) {
    const Repeats a = Waves(count, 1, &random), b = Waves(count, size, &random);
    distinguished += TestSameKind(a, b, 199).distinguished();
  }
  return distinguished;
}

TEST(SameKind, OneInTwentyOfEqualKindsIsDistinguished) {
  // The number of distinguished cases has a binomial distribution with 400 trials at 5 %, so it is
  // 20 ± 4.4. The limits are three and a half standard deviations from the mean. A correct test
  // exceeds them about once in two thousand cases.
  const int distinguished = CountDistinguished(1, 400, 17);
  EXPECT_GE(distinguished, 5);
  EXPECT_LE(distinguished, 35);
}

TEST(SameKind, UnequalKindsAreDistinguished) {
  // The sizes of the two kinds differ by 1.5 standard deviations. Student's test would detect the
  // difference in 98 of 100 cases.
  EXPECT_GE(CountDistinguished(1.3, 100, 17), 90);
  // The test must also distinguish kinds with the same mean but different variances.
  std::mt19937_64 random(3);
  Repeats narrow(17, {0.0}), wide = narrow;
  for (std::size_t k = 0; k < 17; ++k) {
    narrow[k][0] = 0.1 * (static_cast<double>(k) - 8);
    wide[k][0] = 10 * narrow[k][0];
  }
  EXPECT_TRUE(TestSameKind(narrow, wide).distinguished());
}

// The test goes through all 20 ways to divide six numbers into two sets. For series of one sample,
// |x − y| is their rms difference. The sets are the lowest three and the highest three. Among the
// other divisions, only the one with the two sets swapped gives the same distance between the sets.
TEST(SameKind, PIsThatOfGoingThroughAllWays) {
  const Repeats low = {{1}, {2}, {3}}, high = {{11}, {12}, {13}};
  const SameKindTest test = TestSameKind(low, high);
  EXPECT_DOUBLE_EQ(test.distance, 10 - 4.0 / 3);  // distances within each set: 1, 1 and 2
  EXPECT_DOUBLE_EQ(test.min_p, 2.0 / 20);
  EXPECT_FALSE(test.can_distinguish());
  // The standard error of 9999 draws is 0.003.
  EXPECT_NEAR(test.p, 0.1, 0.012);
  EXPECT_FALSE(TestSameKind(low, low).distinguished());
}

TEST(SameKind, StatesFromHowManyRepeatsItCanDistinguish) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {2u, 3u, 4u, 17u})
    EXPECT_EQ(TestSameKind(Waves(n, 1, &random), Waves(n, 9, &random)).can_distinguish(), n >= 4)
        << n;
  EXPECT_TRUE(TestSameKind(Waves(4, 1, &random), Waves(4, 9, &random)).distinguished());
}

}  // namespace
}  // namespace predictor
