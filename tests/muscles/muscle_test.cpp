#include "muscles/muscle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace predictor::muscles {
namespace {

TEST(Muscle, ActiveForceIsLargestAtTheOptimalLength) {
  EXPECT_EQ(ActiveForceLength(1), 1);
  EXPECT_NEAR(ActiveForceLength(0.5), std::exp(-0.25 / 0.45), 1e-15);
  EXPECT_NEAR(ActiveForceLength(1.5), ActiveForceLength(0.5), 1e-15);
}

TEST(Muscle, PassiveForceReachesTheMaximumAtTheStrainOfItsSource) {
  EXPECT_EQ(PassiveForceLength(0.7), 0);
  EXPECT_EQ(PassiveForceLength(1), 0);
  EXPECT_NEAR(PassiveForceLength(1.6), 1, 1e-12);
  EXPECT_NEAR(PassiveForceLength(1.3), std::expm1(2) / std::expm1(4), 1e-12);
}

TEST(Muscle, ForceFallsWithShorteningAndRisesWithLengthening) {
  EXPECT_EQ(ForceVelocity(0), 1);
  EXPECT_EQ(ForceVelocity(-1), 0);
  EXPECT_NEAR(ForceVelocity(-0.5), 0.25, 1e-15);
  EXPECT_NEAR(ForceVelocity(0.1), 1.2 - 0.01 / 0.2, 1e-15);
  EXPECT_EQ(ForceVelocity(0.2), 1.2);
  EXPECT_EQ(ForceVelocity(5), 1.2);
  // The curve must have no kink at rest.
  EXPECT_NEAR((ForceVelocity(1e-6) - 1) / 1e-6, 2, 1e-5);
  EXPECT_NEAR((1 - ForceVelocity(-1e-6)) / 1e-6, 2, 1e-5);
}

// Fibres at 30° must keep their thickness, which is half the optimal length.
TEST(Muscle, PennateFibresKeepTheirThickness) {
  const MuscleParameters muscle = {
      .max_force = 100, .fibre_length = 0.1, .pennation = std::asin(0.5), .tendon_slack = 0.2};
  const double along = 0.1 * std::cos(std::asin(0.5));
  const Fibre optimal = FibreOf(muscle, 0.2 + along, 0);
  EXPECT_NEAR(optimal.length, 1, 1e-12);
  EXPECT_NEAR(optimal.cos_pennation, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(ForcesOf(muscle, optimal).active, 100 * std::sqrt(0.75), 1e-9);
  const Fibre longer = FibreOf(muscle, 0.2 + 0.12, 0.3);
  EXPECT_NEAR(longer.length * 0.1, std::hypot(0.12, 0.05), 1e-12);
  EXPECT_NEAR(longer.velocity, 0.3 * longer.cos_pennation / (kMaxVelocity * 0.1), 1e-12);
  EXPECT_GT(ForcesOf(muscle, longer).passive, 0);
}

TEST(Muscle, APathShorterThanTheTendonIsSlack) {
  const MuscleParameters muscle = {.max_force = 100, .fibre_length = 0.1, .tendon_slack = 0.2};
  const TendonForces forces = ForcesOf(muscle, FibreOf(muscle, 0.19, 0));
  EXPECT_EQ(forces.active, 0);
  EXPECT_EQ(forces.passive, 0);
}

}  // namespace
}  // namespace predictor::muscles
