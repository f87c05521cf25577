// Compares the estimate for censored values with published examples and with its definition.
#include "evaluation/censored.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

std::vector<CensoredValue> Values(const std::vector<double>& exact,
                                  const std::vector<double>& bounds) {
  std::vector<CensoredValue> values;
  for (const double x : bounds) values.push_back({x, true});
  for (const double x : exact) values.push_back({x, false});
  return values;
}

// In the example of Kaplan & Meier (1958), deaths occur after 0.8, 3.1, 5.4 and 9.2 months, and
// losses after 1.0, 2.7, 7.0 and 12.1 months.
TEST(KaplanMeier, GivesItsAuthorsExample) {
  const auto steps = KaplanMeier(Values({0.8, 3.1, 5.4, 9.2}, {1.0, 2.7, 7.0, 12.1}));
  const std::vector<double> shares = {0.875, 0.700, 0.525, 0.2625};
  const std::vector<std::size_t> at_risk = {8, 5, 4, 2};
  ASSERT_EQ(steps.size(), shares.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_NEAR(steps[i].share_above, shares[i], 1e-12);
    EXPECT_EQ(steps[i].at_risk, at_risk[i]);
  }
}

// The data are remissions of leukaemia under 6-mercaptopurine (Freireich et al. 1963). Klein &
// Moeschberger, "Survival Analysis", table 4.1, print the estimate and Greenwood's standard errors.
TEST(KaplanMeier, GivesTheTableOfTheLeukaemiaTrial) {
  const auto values =
      Values({6, 6, 6, 7, 10, 13, 16, 22, 23}, {6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35});
  const auto steps = KaplanMeier(values);
  struct Row {
    double value, share, error;
  };
  const std::vector<Row> table = {{6, .857, .076},  {7, .807, .087},  {10, .753, .096},
                                  {13, .690, .107}, {16, .627, .114}, {22, .538, .128},
                                  {23, .448, .135}};
  ASSERT_EQ(steps.size(), table.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].value, table[i].value);
    EXPECT_NEAR(steps[i].share_above, table[i].share, 6e-4);
    EXPECT_NEAR(steps[i].standard_error, table[i].error, 6e-4);
  }
  EXPECT_EQ(CensoredQuantile(values, 0.5).value, 23);  // the median remission, in weeks
  EXPECT_FALSE(CensoredQuantile(values, 0.5).at_least);
}

TEST(CensoredQuantile, IsABoundWhereTooManyValuesAreCensored) {
  const auto all = Values({}, {30, 31, 32});
  EXPECT_TRUE(CensoredQuantile(all, 0.5).at_least);
  EXPECT_EQ(CensoredQuantile(all, 0.5).value, 31);
  EXPECT_EQ(BoundText(CensoredQuantile(all, 0.5), "%.1f N"), "at least 31.0 N");
  EXPECT_TRUE(std::isnan(CensoredQuantile({}, 0.5).value));
}

TEST(CensoredQuantile, IsTheUsualOneWithoutCensoring) {
  const auto exact = Values({4, 8, 15, 16, 23}, {});
  EXPECT_DOUBLE_EQ(CensoredQuantile(exact, 0.9).value,
                   Quantile(std::vector<double>{4, 8, 15, 16, 23}, 0.9));
}

// A limit censors the values above it. The estimate must find the quantiles below the limit without
// bias and report those above it as unknown.
TEST(CensoredQuantile, FindsTheTrueQuantilesBelowALimit) {
  std::mt19937_64 random(5);
  std::exponential_distribution<double> force(1 / 20.0);
  std::vector<CensoredValue> values;
  for (int i = 0; i < 20000; ++i) {
    const double x = force(random), limit = i % 2 == 0 ? 30 : 15;
    values.push_back({std::min(x, limit), x > limit});
  }
  const CensoredValue known = CensoredQuantile(values, 0.7);
  EXPECT_FALSE(known.at_least);
  EXPECT_NEAR(known.value, -20 * std::log(0.3), 0.6);  // the tolerance is four standard errors
  const CensoredValue unknown = CensoredQuantile(values, 0.9);
  EXPECT_TRUE(unknown.at_least);
  EXPECT_LE(unknown.value, -20 * std::log(0.1));
}

}  // namespace
}  // namespace predictor
