#include "ergonomics/strength.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "ergonomics/posture.h"

namespace predictor::ergonomics {
namespace {

// Chaffin & Andersson's table of Stobbe's data gives means of 77 and 41 N·m for the elbow flexors
// at 90° with the arm at the side. The table is quoted from memory and was not verified.
TEST(Strength, OfTheElbowIsThatOfThePublishedTable) {
  const auto flexion = [](Sex sex) {
    return MeanStrength(StrengthDirection::kElbowFlexion, sex, Degrees(90), 0);
  };
  EXPECT_NEAR(flexion(Sex::kMale), 77, 1);
  EXPECT_NEAR(flexion(Sex::kFemale), 41, 1);
}

// The equations were evaluated by hand for two angles of each direction.
TEST(Strength, FollowsItsEquations) {
  using enum StrengthDirection;
  const auto at = [](StrengthDirection direction, Sex sex, double elbow, double shoulder) {
    return MeanStrength(direction, sex, Degrees(elbow), Degrees(shoulder));
  };
  // 336.29 + 154.4 - 85 - 22.5 = 383.19; 336.29 + 92.64 - 30.6 = 398.33
  EXPECT_NEAR(at(kElbowFlexion, Sex::kMale, 100, 45), 383.19 * 0.1913, 1e-9);
  EXPECT_NEAR(at(kElbowFlexion, Sex::kFemale, 60, 0), 398.33 * 0.1005, 1e-9);
  // 264.153 + 57.5 - 19.125 = 302.528; 264.153 + 34.5 = 298.653
  EXPECT_NEAR(at(kElbowExtension, Sex::kMale, 100, 45), 302.528 * 0.2126, 1e-9);
  EXPECT_NEAR(at(kElbowExtension, Sex::kFemale, 60, 0), 298.653 * 0.1153, 1e-9);
  // 227.338 + 52.5 - 13.32 = 266.518; 227.338 + 31.5 = 258.838
  EXPECT_NEAR(at(kShoulderFlexion, Sex::kMale, 100, 45), 266.518 * 0.2845, 1e-9);
  EXPECT_NEAR(at(kShoulderFlexion, Sex::kFemale, 60, 0), 258.838 * 0.1495, 1e-9);
  // 204.562 + 4.455 = 209.017
  EXPECT_NEAR(at(kShoulderExtension, Sex::kMale, 100, 45), 209.017 * 0.4957, 1e-9);
  EXPECT_NEAR(at(kShoulderExtension, Sex::kFemale, 60, 0), 204.562 * 0.2485, 1e-9);
}

TEST(Strength, ShareCapableFollowsTheNormalDistribution) {
  EXPECT_NEAR(ShareCapable(50, 50), 0.5, 1e-12);
  EXPECT_NEAR(ShareCapable(50 * (1 - 0.3 * 1.6449), 50), 0.95, 1e-5);
  EXPECT_NEAR(ShareCapable(50 * (1 + 0.3 * 1.6449), 50), 0.05, 1e-5);
  EXPECT_EQ(ShareCapable(1, 0), 0);
  EXPECT_EQ(ShareCapable(0, 0), 1);
}

TEST(Strength, SamplesHaveThePublishedSpreadAndCorrelation) {
  RandomStream random(1, "strength");
  constexpr int kPeople = 100'000;
  std::array<double, kStrengthDirections> sum{}, squares{};
  double products = 0;
  for (int person = 0; person < kPeople; ++person) {
    const StrengthShares shares = SampleStrength(&random);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      EXPECT_GE(shares[i], kMinStrengthShare);
      sum[i] += shares[i] - 1;
      squares[i] += (shares[i] - 1) * (shares[i] - 1);
    }
    products += (shares[0] - 1) * (shares[3] - 1);
  }
  // The tolerance is five standard errors. The lower bound of the strength shifts the moments by
  // less than this tolerance.
  const double error = 5 / std::sqrt(static_cast<double>(kPeople));
  for (std::size_t i = 0; i < sum.size(); ++i) {
    EXPECT_NEAR(sum[i] / kPeople, 0, 0.3 * error);
    EXPECT_NEAR(squares[i] / kPeople, 0.09, 0.09 * std::numbers::sqrt2 * error);
  }
  EXPECT_NEAR(products / std::sqrt(squares[0] * squares[3]), 0.7, (1 - 0.49) * error);
}

TEST(Strength, SamplesRepeatForTheSameSeed) {
  RandomStream a(3, "strength"), same(3, "strength"), other(4, "strength");
  const StrengthShares first = SampleStrength(&a);
  EXPECT_EQ(first, SampleStrength(&same));
  EXPECT_NE(first, SampleStrength(&other));
}

}  // namespace
}  // namespace predictor::ergonomics
