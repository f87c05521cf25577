// Compares the results with published tables and examples, and with SciPy 1.17.1.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "evaluation/statistics_samples.h"
#include "evaluation/statistics_signed_rank.h"

namespace predictor {
namespace {

TEST(Samples, HaveTheirTextbookFigures) {
  const std::vector<double> x = {3, 1, 4, 1, 5, 9, 2, 6};
  EXPECT_DOUBLE_EQ(Mean(x), 3.875);
  EXPECT_NEAR(SampleDeviation(x), 2.748376143938713, 1e-14);  // numpy.std(ddof=1)
  EXPECT_DOUBLE_EQ(Median(x), 3.5);
  // The expected values are from numpy.quantile.
  EXPECT_DOUBLE_EQ(Quantile(x, 0), 1);
  EXPECT_DOUBLE_EQ(Quantile(x, 0.25), 1.75);
  EXPECT_NEAR(Quantile(x, 0.9), 6.9, 1e-14);
  EXPECT_DOUBLE_EQ(Quantile(x, 1), 9);
  EXPECT_DOUBLE_EQ(Median(std::vector<double>{7, 1, 3}), 3);
}

TEST(Samples, AreUndefinedWhereTheyShouldBe) {
  const std::vector<double> one = {4};
  EXPECT_TRUE(std::isnan(Mean({})));
  EXPECT_TRUE(std::isnan(Median({})));
  EXPECT_TRUE(std::isnan(SampleDeviation(one)));
  EXPECT_DOUBLE_EQ(Median(one), 4);
  EXPECT_TRUE(std::isnan(Correlation(std::vector<double>{1, 1}, std::vector<double>{1, 2})));
}

TEST(Samples, CorrelateAsScipySays) {
  const std::vector<double> a = {0.5, 1.2, -0.3, 2, 3.3}, b = {0.1, 1, 0, 1.5, 4};
  EXPECT_NEAR(Correlation(a, b), 0.9554250932741326, 1e-14);  // scipy.stats.pearsonr
}

TEST(Holm, AdjustsStepByStep) {
  // The values were computed by hand: 4·0.005, 3·0.01, then 2·0.03, then max(0.04, 0.06).
  const auto p = HolmAdjusted(std::vector<double>{0.01, 0.04, 0.03, 0.005});
  EXPECT_NEAR(p[3], 0.02, 1e-15);
  EXPECT_NEAR(p[0], 0.03, 1e-15);
  EXPECT_NEAR(p[2], 0.06, 1e-15);
  EXPECT_NEAR(p[1], 0.06, 1e-15);
  EXPECT_EQ(HolmAdjusted(std::vector<double>{0.7, 0.9}), (std::vector<double>{1, 1}));
}

// Returns the differences 1, 2, ... n, of which some are negative. The ranks of the negative
// differences have the given sum.
std::vector<double> WithNegativeRanks(std::size_t n, std::size_t sum) {
  std::vector<double> d(n);
  std::iota(d.begin(), d.end(), 1.0);
  for (std::size_t rank = n; rank > 0 && sum > 0; --rank)
    if (rank <= sum) d[rank - 1] = -d[rank - 1], sum -= rank;
  return d;
}

// For each n, textbooks print the largest rank sum that is significant in a two-sided test.
TEST(SignedRank, HasTheCriticalValuesOfThePublishedTables) {
  const std::map<double, std::map<std::size_t, std::size_t>> tables = {
      {0.05, {{6, 0},   {7, 2},   {8, 3},   {9, 5},   {10, 8},  {11, 10}, {12, 13},
              {13, 17}, {14, 21}, {15, 25}, {16, 29}, {17, 34}, {18, 40}, {19, 46},
              {20, 52}, {21, 58}, {22, 65}, {23, 73}, {24, 81}, {25, 89}, {30, 137}}},
      {0.01,
       {{8, 0},
        {9, 1},
        {10, 3},
        {11, 5},
        {12, 7},
        {13, 9},
        {14, 12},
        {15, 15},
        {16, 19},
        {17, 23},
        {18, 27},
        {19, 32},
        {20, 37},
        {25, 68}}}};
  for (const auto& [level, table] : tables)
    for (const auto& [n, sum] : table) {
      const auto at = TestSignedRank(WithNegativeRanks(n, sum));
      EXPECT_EQ(at.minus, static_cast<double>(sum));
      EXPECT_LE(at.p, level) << n;
      EXPECT_GT(TestSignedRank(WithNegativeRanks(n, sum + 1)).p, level) << n;
    }
  EXPECT_GT(TestSignedRank(WithNegativeRanks(5, 0)).p, 0.05);  // five differences can never be
                                                               // significant
}

// The data are Hamilton's depression factor before and after therapy (Hollander & Wolfe, example
// 3.1).
const std::vector<double> kHamilton = {1.83 - 0.878, 0.50 - 0.647, 1.62 - 0.598,
                                       2.48 - 2.05,  1.68 - 1.06,  1.88 - 1.29,
                                       1.55 - 1.06,  3.06 - 3.14,  1.30 - 1.29};
// The data are from Darwin's comparison of crossed and self-fertilised maize, in eighths of an
// inch.
const std::vector<double> kMaize = {49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48};

TEST(SignedRank, AgreesWithPublishedExamples) {
  const auto hamilton = TestSignedRank(kHamilton);
  EXPECT_EQ(hamilton.plus, 40);
  EXPECT_EQ(hamilton.minus, 5);
  EXPECT_TRUE(hamilton.exact);
  EXPECT_FALSE(hamilton.tied);
  EXPECT_DOUBLE_EQ(hamilton.p, 0.0390625);
  EXPECT_DOUBLE_EQ(TestSignedRank(kMaize).p, 0.041259765625);
}

TEST(HodgesLehmannEstimate, AgreesWithPublishedExamples) {
  // For the negated differences, Hollander & Wolfe give −0.46 with (−0.786, −0.010) at 96.1 %.
  const auto hamilton = HodgesLehmann(kHamilton);
  EXPECT_NEAR(hamilton.estimate, 0.46, 1e-12);
  EXPECT_NEAR(hamilton.lower, 0.010, 1e-12);
  EXPECT_NEAR(hamilton.upper, 0.786, 1e-12);
  EXPECT_DOUBLE_EQ(hamilton.confidence, 0.9609375);
  const auto maize = HodgesLehmann(kMaize);
  EXPECT_DOUBLE_EQ(maize.estimate, 25);
  EXPECT_DOUBLE_EQ(maize.lower, 4);
  EXPECT_DOUBLE_EQ(maize.upper, 41.5);
  EXPECT_NEAR(maize.confidence, 0.95208740234375, 1e-12);
}

// The data are differences of answers, with ties and zeros.
const std::vector<double> kLikert = {1, 0, -1, 2, 1, 1, 0, 1, -1, 2, 0, 1, 1, 3, -2, 1, 0};

TEST(SignedRank, TreatsTiesAndZerosByTheNamedRule) {
  // The expected value is from scipy.stats.wilcoxon(zero_method,
  // method=PermutationMethod(n_resamples=inf)), over all 2^13 signs.
  const auto dropped = TestSignedRank(kLikert, ZeroRule::kDropped);
  EXPECT_EQ(dropped.zeros, 4u);
  EXPECT_EQ(dropped.ranked, 13u);
  EXPECT_TRUE(dropped.tied);
  EXPECT_TRUE(dropped.exact);
  EXPECT_DOUBLE_EQ(dropped.minus, 21);
  EXPECT_DOUBLE_EQ(dropped.p, 0.0986328125);
  const auto pratt = TestSignedRank(kLikert, ZeroRule::kPratt);
  EXPECT_DOUBLE_EQ(pratt.minus, 33);
  EXPECT_DOUBLE_EQ(pratt.p, 0.0693359375);
}

TEST(SignedRank, ApproximatesAsScipyDoes) {
  // The expected value is from scipy.stats.wilcoxon(zero_method, correction=True, method="approx").
  const auto dropped = TestSignedRank(kLikert, ZeroRule::kDropped, 0);
  EXPECT_FALSE(dropped.exact);
  EXPECT_NEAR(dropped.z, 1.7445896740435536, 1e-12);
  EXPECT_NEAR(dropped.p, 0.08105631954264096, 1e-12);
  const auto pratt = TestSignedRank(kLikert, ZeroRule::kPratt, 0);
  EXPECT_NEAR(pratt.p, 0.06473591187992067, 1e-12);
  const auto maize = TestSignedRank(kMaize, ZeroRule::kDropped, 0);
  EXPECT_NEAR(maize.p, 0.043772323763041174, 1e-12);
}

TEST(SignedRank, ApproximatesBeyondWhatIsEnumerated) {
  std::vector<double> d;
  for (int i = 0; i < 80; ++i) d.push_back(std::nearbyint(i * 37 % 101 / 10.0 - 4.2));
  const auto dropped = TestSignedRank(d);
  EXPECT_FALSE(dropped.exact);
  EXPECT_NEAR(dropped.p, 0.01967628993582606, 1e-10);
  EXPECT_NEAR(TestSignedRank(d, ZeroRule::kPratt).p, 0.025556897046253094, 1e-10);
}

// Compares the p-value with an explicit enumeration of all signs.
TEST(SignedRank, EnumeratesWhatGoingThroughAllSignsGives) {
  std::mt19937 random(5);
  for (int round = 0; round < 40; ++round) {
    std::vector<double> d(1 + random() % 9);
    for (double& x : d) x = static_cast<double>(random() % 7) - 3;
    const auto test = TestSignedRank(d);
    std::vector<double> signless;
    for (const double x : d)
      if (x != 0) signless.push_back(std::abs(x));
    const std::size_t n = signless.size();
    std::vector<double> rank(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        rank[i] += signless[j] < signless[i] ? 1 : signless[j] == signless[i] ? 0.5 : 0;
    for (double& r : rank) r += 0.5;
    double below = 0, above = 0;
    for (std::uint32_t signs = 0; signs < 1u << n; ++signs) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += (signs >> i & 1) != 0 ? rank[i] : 0;
      below += sum <= test.plus ? 1 : 0;
      above += sum >= test.plus ? 1 : 0;
    }
    const double all = static_cast<double>(1u << n);
    EXPECT_DOUBLE_EQ(test.p, std::min(1.0, 2 * std::min(below, above) / all));
  }
}

TEST(SignedRank, HasNoResultWithoutDifferences) {
  const auto none = TestSignedRank({});
  EXPECT_EQ(none.p, 1);
  const auto zeros = TestSignedRank(std::vector<double>(5, 0.0), ZeroRule::kPratt);
  EXPECT_EQ(zeros.p, 1);
  EXPECT_EQ(zeros.zeros, 5u);
  EXPECT_TRUE(std::isnan(HodgesLehmann({}).estimate));
}

TEST(HodgesLehmannEstimate, StatesTheConfidenceOfFewDifferences) {
  const auto three = HodgesLehmann(std::vector<double>{1, 5, 2});
  EXPECT_EQ(three.lower, 1);
  EXPECT_EQ(three.upper, 5);
  EXPECT_DOUBLE_EQ(three.confidence, 0.75);  // 1 − 2/2³
  EXPECT_DOUBLE_EQ(HodgesLehmann(std::vector<double>{4}).confidence, 0);
}

// The interval must contain the true shift at least as often as stated, even for coarse answers.
TEST(HodgesLehmannEstimate, CoversTheShiftAsOftenAsItSays) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.7, 1);
  for (const bool coarse : {false, true}) {
    int covered = 0;
    constexpr int kRounds = 2000;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<double> d(17);
      // Coarse values are multiples of 0.5, symmetric about a shift of 0.5.
      for (double& x : d)
        x = coarse ? std::nearbyint(2 * (noise(random) - 0.2)) / 2 : noise(random);
      const auto interval = HodgesLehmann(d);
      const double shift = coarse ? 0.5 : 0.7;
      covered += interval.lower <= shift && shift <= interval.upper ? 1 : 0;
    }
    EXPECT_GT(covered, 0.94 * kRounds) << coarse;  // 95.5 % minus three standard errors
    if (!coarse) {
      EXPECT_LT(covered, 0.97 * kRounds);
    }
  }
}

// If both intervals are available, the approximate one must agree with the enumerated one.
TEST(HodgesLehmannEstimate, ApproximatesBeyondWhatIsEnumerated) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  std::vector<double> d(40);
  for (double& x : d) x = noise(random);
  const auto exact = HodgesLehmann(d), approximate = HodgesLehmann(d, 0.95, 0);
  EXPECT_EQ(exact.estimate, approximate.estimate);
  EXPECT_NEAR(exact.lower, approximate.lower, 0.02);
  EXPECT_NEAR(exact.upper, approximate.upper, 0.02);
  EXPECT_NEAR(exact.confidence, approximate.confidence, 0.002);
}

}  // namespace
}  // namespace predictor
