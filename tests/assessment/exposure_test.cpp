#include "assessment/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/random.h"

namespace predictor::assessment {
namespace {

using ergonomics::FatigueJoint;

// Returns the load moment [N·m] during lifts of 2 s whose peaks are `peaks` [N·m]. The lifts are 3
// s apart, so that the low-pass filter settles.
std::vector<double> LiftsWith(const std::vector<double>& peaks) {
  std::vector<double> moment(300, 0);
  for (const double peak : peaks) {
    moment.insert(moment.end(), 200, peak);
    moment.insert(moment.end(), 300, 0);
  }
  return moment;
}

DamageResult OfBack(const std::vector<double>& moment) {
  return DamageOfMoment(ergonomics::kLiftTool, "lower back", moment);
}

TEST(Exposure, AddsTheDamageOfEachLift) {
  const std::vector<double> moment = LiftsWith({60, 90, 60});
  const DamageResult result = OfBack(moment);
  const double expected = 2 * ergonomics::LiftDamage(60) + ergonomics::LiftDamage(90);
  EXPECT_NEAR(result.per_run / expected, 1, 0.01);
  const double runs = 8 * 3600 / (static_cast<double>(moment.size()) / 100);
  EXPECT_NEAR(result.shift_share / (runs * result.day_share), 1, 1e-9);
  EXPECT_GT(result.probability, 0);
}

// Both hands are at 0.4 m. The force of each hand contains noise of 3 N rms and a tremor of 1 N at
// 10 Hz.
TEST(Exposure, NoiseAndTremorHardlyChangeTheDamage) {
  const std::vector<double> clean = LiftsWith({40, 40, 40});
  std::vector<double> noisy = clean;
  RandomStream random(7, "noise");
  for (std::size_t i = 0; i < noisy.size(); ++i)
    noisy[i] += 0.4 * (std::sqrt(2) * 3 * random.Normal() +
                       std::sin(2 * std::numbers::pi * 0.1 * static_cast<double>(i)));
  EXPECT_NEAR(OfBack(noisy).per_run / OfBack(clean).per_run, 1, 0.1);
}

TEST(Exposure, ASteadyMomentIsOneLift) {
  const std::vector<double> moment(3000, 50);
  EXPECT_NEAR(OfBack(moment).per_run / ergonomics::LiftDamage(50), 1, 0.01);
}

// LiFFT is valid up to 100 N·m, and the Shoulder Tool states no such limit.
TEST(Exposure, ALoadBeyondTheRangeOfTheToolIsMarked) {
  EXPECT_FALSE(OfBack(LiftsWith({60, 98})).outside());
  const DamageResult beyond = OfBack(LiftsWith({60, 120}));
  EXPECT_TRUE(beyond.outside());
  EXPECT_NEAR(beyond.load_over_range, 1.2, 0.01);
  EXPECT_FALSE(
      DamageOfMoment(ergonomics::kShoulderTool, "left shoulder", LiftsWith({120})).outside());
}

// The low-passed moment has the samples of the moment, and no delay.
TEST(Exposure, TheSmoothMomentIsSymmetric) {
  const std::vector<double> moment = LiftsWith({80});
  const std::vector<double> smooth = SmoothMoment(moment);
  ASSERT_EQ(smooth.size(), moment.size());
  EXPECT_NEAR(smooth[400], 80, 0.5);
  EXPECT_NEAR(smooth[300 - 20], smooth[499 + 20], 0.01);
}

TEST(Exposure, AShortGapIsFilledAndALongOneIsNot) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> load(100, 3);
  load[0] = load[50] = gap;
  load[49] = 7;
  const auto filled = WithoutGaps(load);
  ASSERT_TRUE(filled);
  EXPECT_EQ((*filled)[0], 3);
  EXPECT_EQ((*filled)[50], 7);
  for (std::size_t i = 60; i < 64; ++i) load[i] = gap;
  EXPECT_FALSE(WithoutGaps(load));  // 6 of 100
  EXPECT_FALSE(WithoutGaps({gap}));
}

// Compares the computation with the closed form of 3CC-r under a constant load.
TEST(Exposure, FatigueFollowsTheClosedForm) {
  const auto rates = ergonomics::FatigueRatesOf(FatigueJoint::kShoulder);
  const std::vector<double> load(6000, 0.3);
  const FatigueResult result = FatigueOfLoad("left shoulder", FatigueJoint::kShoulder, load);
  EXPECT_NEAR(result.mean_load, 0.3, 1e-12);
  // The closed form begins with a fully developed load, which the model reaches in less than a
  // second.
  EXPECT_NEAR(1 - result.compartments.capacity,
              ergonomics::FatiguedShareUnderConstantLoad(0.3, 60, rates), 0.002);
  EXPECT_NEAR(result.compartments.time_to_limit / ergonomics::EnduranceTime(0.3, rates), 1, 0.02);
}

// Under a constant load, Ma's capacity is exp(-k load t), and the endurance time is -ln(load) / (k
// load).
TEST(Exposure, MasModelFollowsItsClosedForm) {
  const FatigueResult result =
      FatigueOfLoad("left elbow", FatigueJoint::kElbow, std::vector<double>(6000, 0.4));
  EXPECT_NEAR(result.ma.capacity, std::exp(-0.4), 1e-9);
  EXPECT_NEAR(result.ma.time_to_limit, -60 * std::log(0.4) / 0.4, 0.2);
  EXPECT_NEAR(result.endurance, 17.98 * std::pow(0.4, -2.21), 1e-9);
  EXPECT_FALSE(result.trial);
}

// A run with the load of the trial exhausts the person after the time of the trial.
TEST(Exposure, AStatedTrialExhaustsAfterItsTime) {
  const ergonomics::TrialFatigue trial{.reference_load = 0.4, .reference_time = 120};
  const FatigueResult result =
      FatigueOfLoad("left elbow", FatigueJoint::kElbow, std::vector<double>(3000, 0.4), trial);
  ASSERT_TRUE(result.trial);
  EXPECT_NEAR(result.trial->time_to_limit, 120, 0.2);
  EXPECT_NEAR(result.trial->capacity, std::pow(1 - ergonomics::kTrialExhaustion, 30. / 120), 1e-9);
  const FatigueResult rested =
      FatigueOfLoad("left elbow", FatigueJoint::kElbow, std::vector<double>(3000, 0.05), trial);
  EXPECT_EQ(rested.trial->capacity, 1);
  EXPECT_TRUE(std::isinf(rested.trial->time_to_limit));
}

TEST(Exposure, ALightLoadStaysPossible) {
  const std::vector<double> load(3000, 0.02);
  const FatigueResult result = FatigueOfLoad("left elbow", FatigueJoint::kElbow, load);
  EXPECT_TRUE(std::isinf(result.compartments.time_to_limit));
}

}  // namespace
}  // namespace predictor::assessment
