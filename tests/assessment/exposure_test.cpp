#include "assessment/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace predictor::assessment {
namespace {

using ergonomics::FatigueJoint;

// Two lifts with a load moment of 60 N·m and one with 90 N·m, as half waves.
TEST(Exposure, AddsTheDamageOfEachLift) {
  std::vector<double> moment;
  for (const double peak : {60.0, 90.0, 60.0})
    for (int i = 0; i <= 200; ++i) moment.push_back(peak * std::sin(std::numbers::pi * i / 200));
  const DamageResult result = DamageOfMoment("LiFFT", "lower back", moment, 6.03,
                                             ergonomics::LiftDamage, ergonomics::kLiftRisk);
  const double expected = 2 * ergonomics::LiftDamage(60) + ergonomics::LiftDamage(90);
  EXPECT_NEAR(result.per_run / expected, 1, 1e-9);
  const double runs = 8 * 3600 / (6.03);
  EXPECT_NEAR(result.shift_share / (runs * result.day_share), 1, 1e-9);
  EXPECT_GT(result.probability, 0);
}

TEST(Exposure, DoesNotCountNoise) {
  std::vector<double> moment(3000);
  for (std::size_t i = 0; i < moment.size(); ++i)
    moment[i] = 50 + 0.4 * std::sin(1.3 * static_cast<double>(i));
  EXPECT_EQ(DamageOfMoment("LiFFT", "lower back", moment, 6.03, ergonomics::LiftDamage,
                           ergonomics::kLiftRisk)
                .per_run,
            0);
}

// The closed form of 3CC-r under a constant load.
TEST(Exposure, FatigueFollowsTheClosedForm) {
  const auto rates = ergonomics::FatigueRatesOf(FatigueJoint::kShoulder);
  const std::vector<double> load(6000, 0.3);
  const FatigueResult result = FatigueOfLoad("left shoulder", FatigueJoint::kShoulder, load);
  EXPECT_NEAR(result.mean_load, 0.3, 1e-12);
  // The closed form begins with the load fully developed; that takes less than a second.
  EXPECT_NEAR(1 - result.capacity, ergonomics::FatiguedShareUnderConstantLoad(0.3, 60, rates),
              0.002);
  EXPECT_NEAR(result.time_to_limit / ergonomics::EnduranceTime(0.3, rates), 1, 0.02);
}

TEST(Exposure, ALightLoadStaysPossible) {
  const std::vector<double> load(3000, 0.02);
  EXPECT_TRUE(std::isinf(FatigueOfLoad("left elbow", FatigueJoint::kElbow, load).time_to_limit));
}

}  // namespace
}  // namespace predictor::assessment
