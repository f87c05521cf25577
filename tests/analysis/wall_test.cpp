// Compares walls in the linear loop with closed forms.
#include "haptics/wall.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/check/contact.h"
#include "analysis/spring_and_mass.h"
#include "support/constants.h"

namespace predictor {
namespace {

Wall AlongX(double stiffness, double damping) {
  Wall wall;
  wall.normal = Vector3::UnitX();
  wall.stiffness = stiffness;
  wall.damping = damping;
  return wall;
}

TEST(Wall, AddsItsSpringDamperAndInertiaToAMass) {
  Wall wall = AlongX(800, 30);
  wall.inertia = 2;
  EXPECT_NEAR(MassAt(Mass(6, 10), wall), 6, 1e-12);
  const LinearModel model = WithWall(Mass(6, 10), wall);
  EXPECT_NEAR(model.A(1, 0), -800.0 / 8, 1e-12);
  EXPECT_NEAR(model.A(1, 1), -40.0 / 8, 1e-12);
  EXPECT_NEAR(model.B(1, 0), 1.0 / 8, 1e-12);
}

// The body moves along y and rotates about z, and the wall acts at a distance from its centre.
TEST(Wall, ActsAtItsPoint) {
  constexpr double kMass = 3, kInertia = 0.2, kArm = 0.4;
  LinearModel body;
  body.dof = 2;
  body.A = Eigen::MatrixXd::Zero(4, 4);
  body.A.topRightCorner(2, 2).setIdentity();
  body.B = Eigen::MatrixXd::Zero(4, 12);
  body.B(2, 1) = 1 / kMass, body.B(3, 5) = 1 / kInertia;
  body.C = Eigen::MatrixXd::Zero(12, 4);
  body.C(1, 2) = body.C(5, 3) = 1;
  Wall wall;
  wall.p_DC = {kArm, 0, 0};
  wall.normal = Vector3::UnitY();
  wall.stiffness = 500;
  EXPECT_NEAR(MassAt(body, wall), 1 / (1 / kMass + kArm * kArm / kInertia), 1e-12);
  const LinearModel model = WithWall(body, wall);
  EXPECT_NEAR(model.A(2, 0), -500 / kMass, 1e-9);
  EXPECT_NEAR(model.A(2, 1), -500 * kArm / kMass, 1e-9);
  EXPECT_NEAR(model.A(3, 0), -500 * kArm / kInertia, 1e-9);
  EXPECT_NEAR(model.A(3, 1), -500 * kArm * kArm / kInertia, 1e-9);
}

// A delay T of the motion multiplies the impedance Z = K − M ω² + j ω B by e^{jωT}. The delay adds
// apparent damping to a wall and removes damping from an inertia.
TEST(ImpedanceAt, OfAMassAtAWallThroughADelay) {
  constexpr double T = 0.02, kMass = 9, kDamper = 15, kFrequency = 5;
  const double omega = 2 * kPi * kFrequency;
  const LinearModel world = WithWall(Mass(kMass, kDamper), AlongX(5000, 40));
  const FeltImpedance felt = ImpedanceAt(world, PureDelay(T), 0, kDt, Vector3::UnitX(), kFrequency);
  const std::complex<double> requested(5000 - kMass * omega * omega, omega * (kDamper + 40));
  EXPECT_LT(std::abs(felt.requested - requested), 1e-6 * std::abs(requested));
  const std::complex<double> rendered = requested * std::polar(1.0, omega * T);
  EXPECT_LT(std::abs(felt.rendered - rendered), 1e-3 * std::abs(rendered));
}

TEST(ImpedanceAt, AtRestIsTheOneRequested) {
  Scenario s = PureDelay(0.02);
  s.device.left->loop = {15, 0.9, 0.004};
  s.rendering.kp = 2;
  const LinearModel world = WithWall(Mass(9, 15), AlongX(5000, 40));
  const FeltImpedance felt = ImpedanceAt(world, s, 0.01, kDt, Vector3::UnitX(), 0.01);
  EXPECT_NEAR(felt.rendered.real(), 5000, 5);
}

// M s² + B s + K + m s² e^−sT describes a hand of mass m that acts on a wall through a delay. The
// stability boundary of this system is at B = −m ω sin ωT and K = M ω² + m ω² cos ωT.
TEST(StiffestStableWall, FindsTheClosedForm) {
  constexpr double T = 0.02, kMass = 9, kHand = 2;
  for (const double phase : {1.1 * kPi, 1.15 * kPi}) {
    const double omega = phase / T;
    const double damping = -kHand * omega * std::sin(phase);
    const double critical = (kMass + kHand * std::cos(phase)) * omega * omega;
    HandSpec hand = Spring(0);
    hand.mass = kHand;
    const WallLimit limit = StiffestStableWall(Mass(kMass, 0), PureDelay(T), hand, 0,
                                               AlongX(0, damping), LoopModel::kExact);
    EXPECT_TRUE(limit.reached);
    EXPECT_NEAR(limit.stiffness, critical, 0.06 * critical);
    EXPECT_NEAR(limit.frequency, omega / (2 * kPi), 0.06 * omega / (2 * kPi));
  }
}

TEST(StiffestStableWall, HasNoLimitWithoutDelay) {
  const WallLimit limit =
      StiffestStableWall(Mass(9, 5), PureDelay(0), Spring(100), 0, AlongX(0, 5), LoopModel::kExact);
  EXPECT_FALSE(limit.reached);
}

TEST(NormalToward, IsThatOfTheSideThatFacesThePoint) {
  FixtureSpec fixture;
  fixture.size = {1, 2, 0.1};
  fixture.xyz = {0.6, 0, 0};
  EXPECT_LT((NormalToward(fixture, {0.7, 0.5, 0.3}) - Vector3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((NormalToward(fixture, {0.7, -1.5, 0.3}) + Vector3::UnitY()).norm(), 1e-12);
  fixture.shape = FixtureShape::kPlane;
  fixture.rpy = {0, -kPi / 2, 0};
  EXPECT_LT((NormalToward(fixture, {0, 0, 5}) + Vector3::UnitX()).norm(), 1e-12);
  fixture.shape = FixtureShape::kSphere;
  EXPECT_LT((NormalToward(fixture, {0.6, 0, -3}) + Vector3::UnitZ()).norm(), 1e-12);
  fixture.shape = FixtureShape::kCapsule;  // its axis is along x
  EXPECT_LT((NormalToward(fixture, {0.9, 3, 0}) - Vector3::UnitY()).norm(), 1e-12);
  fixture.shape = FixtureShape::kCylinder;
  fixture.size = {0.2, 0.5, 0};
  EXPECT_LT((NormalToward(fixture, {2, 0.1, 0}) - Vector3::UnitX()).norm(), 1e-12);
}

}  // namespace
}  // namespace predictor
