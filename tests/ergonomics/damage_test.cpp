// Compares rainflow counting and cumulative damage with published examples.
#include "ergonomics/damage.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "core/random.h"

namespace predictor::ergonomics {
namespace {

std::map<double, double> CountsByRange(const std::vector<LoadCycle>& cycles) {
  std::map<double, double> counts;
  for (const LoadCycle& cycle : cycles) counts[cycle.range] += cycle.count;
  return counts;
}

// The example is figure 6 of ASTM E1049-85.
TEST(Rainflow, CountsTheExampleOfItsStandard) {
  const std::vector<double> signal = {-2, 1, -3, 5, -1, 3, -4, 4, -2};
  const auto cycles = CountRainflow(signal);
  EXPECT_EQ(CountsByRange(cycles),
            (std::map<double, double>{{3, 0.5}, {4, 1.5}, {6, 0.5}, {8, 1}, {9, 0.5}}));
  ASSERT_EQ(cycles.size(), 7u);
  EXPECT_EQ(cycles[2].mean, 1);  // from -1 to 3, the only whole cycle
  EXPECT_EQ(cycles[2].count, 1);
}

// Additional samples between the reversals and repeated samples must not change the result.
TEST(Rainflow, SeesReversalsOnly) {
  const std::vector<double> plain = {0, 10, 0, 10, 0};
  const std::vector<double> sampled = {0, 0, 3, 10, 10, 8, 0, 5, 10, 4, 4, 0, 0};
  EXPECT_EQ(CountsByRange(CountRainflow(plain)), CountsByRange(CountRainflow(sampled)));
  EXPECT_TRUE(CountRainflow({}).empty());
  EXPECT_TRUE(CountRainflow(std::array{5.0, 5.0, 5.0}).empty());
}

// Each whole cycle removes its range from the signal's path twice, and each half cycle removes it
// once.
TEST(Rainflow, AccountsForTheWholePath) {
  RandomStream random(1, "rainflow");
  for (int run = 0; run < 50; ++run) {
    std::vector<double> signal;
    for (int i = 0; i < 300; ++i) signal.push_back(random.Normal());
    double path = 0, counted = 0;
    for (std::size_t i = 1; i < signal.size(); ++i) path += std::abs(signal[i] - signal[i - 1]);
    for (const LoadCycle& cycle : CountRainflow(signal)) counted += 2 * cycle.count * cycle.range;
    EXPECT_NEAR(counted, path, 1e-9 * path);
  }
}

TEST(Rainflow, IgnoresRangesBelowTheThreshold) {
  const std::vector<double> signal = {0, 10, 9, 10, 0, 1, 0};
  for (const LoadCycle& cycle : CountRainflow(signal, 2)) EXPECT_GE(cycle.range, 2);
  EXPECT_EQ(CountsByRange(CountRainflow(signal, 2)), (std::map<double, double>{{10, 1}}));
}

// A load of 30 lb is lifted at 0.5 m, 760 times a day. The damage was computed independently from
// Zelik's equations.
TEST(Lift, HasTheDamageOfItsEquation) {
  const double damage = 760 * LiftDamage(30 * 0.45359237 * 9.81 * 0.5);
  EXPECT_NEAR(damage, 0.00695, 0.00005);
  EXPECT_NEAR(kLiftRisk.Probability(damage), 0.377, 0.001);
}

// In the abstract of Zelik et al. 2022, an exoskeleton of 30 N·m "is projected to reduce cumulative
// back damage by ~70 %".
TEST(Lift, AssistanceReducesDamageAsPublished) {
  const double left = LiftDamage(50 - 30) / LiftDamage(50);
  EXPECT_NEAR(1 - left, 0.70, 0.05);
}

// Table 1 of DUET (Gallagher et al. 2018) gives the cycles to failure by effort. The table rounds
// the stress to 0.1 %, which changes the cycles by 0.8 % at most.
TEST(Hand, HasTheCyclesToFailureOfThePublishedTable) {
  constexpr std::array<double, 11> kCycles = {3842605, 2231607, 729651, 242301, 79223, 26308,
                                              8602,    2856,    949,    310,    103};
  for (std::size_t effort = 0; effort < kCycles.size(); ++effort)
    EXPECT_NEAR(HandDamage(static_cast<double>(effort)) * kCycles[effort], 1, 0.01) << effort;
}

TEST(Hand, HasTheProbabilitiesOfThePublishedExamples) {
  EXPECT_NEAR(5400 * HandDamage(2), 0.0074, 0.00005);
  EXPECT_NEAR(kHandRisk.Probability(5400 * HandDamage(2)), 0.265, 0.0005);
  EXPECT_NEAR(kHandRisk.Probability(1350 * HandDamage(4)), 0.321, 0.0005);
  // A wrong version of DUET that agrees with the example above would give 65 % here instead of 41
  // %.
  EXPECT_NEAR(kHandRisk.Probability(500 * HandDamage(6)), 0.41, 0.005);
}

// The test cases were published by Bani Hani.
TEST(Shoulder, HasTheDamageOfThePublishedExamples) {
  constexpr double kPoundForce = 4.4482216, kInch = 0.0254;
  const double one_hand = 2880 * ShoulderDamage(ShoulderMoment(2 * kPoundForce, 16 * kInch));
  EXPECT_NEAR(one_hand, 0.00428, 0.005 * 0.00428);
  EXPECT_NEAR(kShoulderRisk.Probability(one_hand), 0.208, 0.0005);
  // For an unknown reason, the published damage of the second case is 2.6 % larger than the
  // computed one.
  const double two_hands = 4800 * ShoulderDamage(ShoulderMoment(5 * kPoundForce, 18 * kInch));
  EXPECT_NEAR(two_hands, 0.03331, 0.03 * 0.03331);
  EXPECT_NEAR(kShoulderRisk.Probability(two_hands), 0.376, 0.003);
  // The pairs of damage and probability were published.
  EXPECT_NEAR(kShoulderRisk.Probability(0.03331), 0.376, 0.0005);
  EXPECT_NEAR(kShoulderRisk.Probability(0.04097), 0.396, 0.0005);
  EXPECT_NEAR(kShoulderRisk.Probability(0.19214), 0.550, 0.0005);
}

TEST(Damage, ReferenceDayIsAsLikelyAsNot) {
  for (const DamageRisk& risk : {kLiftRisk, kHandRisk, kShoulderRisk}) {
    EXPECT_NEAR(risk.Probability(risk.DailyDamage(0.5)), 0.5, 1e-12);
    EXPECT_NEAR(risk.Probability(risk.DailyDamage(0.2)), 0.2, 1e-12);
    EXPECT_NEAR(ShareOfReferenceDay(risk.DailyDamage(0.5) / 1000, risk), 0.001, 1e-12);
    EXPECT_EQ(risk.Probability(0), 0);
  }
}

// A shift contains three lifts a minute to 60 N·m, with noise of 1 N·m.
TEST(Damage, OfARunIsThatOfItsLifts) {
  std::vector<double> moment;
  for (int lift = 0; lift < 3; ++lift)
    for (int i = 0; i < 200; ++i)
      moment.push_back(60 * std::abs(std::sin(std::numbers::pi * i / 200)) + (i % 2) * 0.5);
  moment.push_back(0);
  const double run = DamageOf(CountRainflow(moment, 5), LiftDamage);
  EXPECT_NEAR(run / (3 * LiftDamage(60)), 1, 0.03);
  EXPECT_NEAR(DamageOfShift(run, 60) / run, 480, 1e-9);
}

}  // namespace
}  // namespace predictor::ergonomics
