#include "core/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/histogram.h"

namespace predictor {
namespace {

TEST(RandomStream, RepeatsForTheSameSeedAndUseOnly) {
  RandomStream a(7, "tremor"), same(7, "tremor"), use(7, "noise"), seed(8, "tremor");
  int equal_use = 0, equal_seed = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto x = a.Next();
    EXPECT_EQ(x, same.Next());
    equal_use += x == use.Next();
    equal_seed += x == seed.Next();
  }
  EXPECT_EQ(equal_use, 0);
  EXPECT_EQ(equal_seed, 0);
}

TEST(RandomStream, ContinuesWithOtherNumbersAfterANewSeed) {
  const auto after = [](const char* use, std::uint64_t seed) {
    RandomStream stream(7, use);
    stream.Normal();  // a second number is kept for later
    stream.Reseed(seed);
    return std::array{stream.Normal(), stream.Uniform(), stream.Normal()};
  };
  EXPECT_EQ(after("tremor", 1), after("tremor", 1));
  EXPECT_NE(after("tremor", 1), after("tremor", 2));
  EXPECT_NE(after("tremor", 1), after("noise", 1));
  RandomStream fresh(7, "tremor");
  fresh.Normal();
  EXPECT_NE(after("tremor", 1)[0], fresh.Normal());
}

// The numbers of neighbouring seeds, and those of two streams with the same seed, are uncorrelated.
// The correlation of n independent pairs has the standard deviation 1/sqrt(n).
TEST(RandomStream, IsIndependentOfOtherSeedsAndStreams) {
  const int n = 20000;
  double seeds = 0, streams = 0;
  for (int k = 0; k < n; ++k) {
    RandomStream a(7, "tremor"), next(7, "tremor"), other(7, "noise");
    const auto seed = static_cast<std::uint64_t>(k);
    a.Reseed(seed), next.Reseed(seed + 1), other.Reseed(seed);
    const double x = a.Normal();
    seeds += x * next.Normal();
    streams += x * other.Normal();
  }
  EXPECT_LT(std::abs(seeds / n), 4 / std::sqrt(n));
  EXPECT_LT(std::abs(streams / n), 4 / std::sqrt(n));
}

TEST(RandomStream, NormalHasTheMomentsOfANormalDistribution) {
  RandomStream random(1, "moments");
  constexpr int kN = 400'000;
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  for (int i = 0; i < kN; ++i) {
    const double x = random.Normal();
    m1 += x, m2 += x * x, m3 += x * x * x, m4 += x * x * x * x;
  }
  // The tolerances are five standard errors of the first four moments: sqrt(1/n), sqrt(2/n),
  // sqrt(15/n) and sqrt(96/n).
  const double e = 5 / std::sqrt(static_cast<double>(kN));
  EXPECT_NEAR(m1 / kN, 0, e);
  EXPECT_NEAR(m2 / kN, 1, e * std::sqrt(2.0));
  EXPECT_NEAR(m3 / kN, 0, e * std::sqrt(15.0));
  EXPECT_NEAR(m4 / kN, 3, e * std::sqrt(96.0));
}

TEST(Histogram, QuantilesAreWithinABucketOfTheTrueOnes) {
  auto histogram = std::make_unique<Histogram>();
  for (int i = 1; i <= 10'000; ++i) histogram->Add(i * 0.01);
  for (const double p : {0.01, 0.5, 0.9, 0.999})
    EXPECT_NEAR(histogram->Quantile(p), 100 * p, 1.1 * p);
  EXPECT_EQ(histogram->max(), 100);
  EXPECT_EQ(histogram->Quantile(1), 100);
}

}  // namespace
}  // namespace predictor
