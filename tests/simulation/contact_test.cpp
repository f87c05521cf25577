// Compares contacts of a free body and fixtures with closed forms of rigid bodies with Coulomb
// friction.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "free_body.h"
#include "simulation/mujoco/contact_law.h"

namespace predictor {
namespace {

// ---- a ball on the floor -----------------------------------------------------------------------

// Presses a ball that just touches the floor, and returns its depth [m] after a time [s].
double DepthOnFloor(double force, double time) {
  constexpr double kRadius = 0.05;  // [m]
  Scenario s = SceneOfBody(Shape::kSphere, {kRadius, 0, 0}, {}, 0, EngineKind::kMujoco);
  s.environment.floor = true;
  FreeBody body(s);
  body.Place({Vector3(2, 0, kRadius), Quaternion::Identity()});
  Wrench press = Wrench::Zero();
  press[2] = -force;
  body.Run(time, press);
  return kRadius - body.pose().p.z();
}

TEST(FloorContact, HasTheStiffnessOfItsLaw) {
  const double light = 1 / LightContactLaw(kBodyMass).stiffness;
  EXPECT_NEAR(DepthOnFloor(1, 1), light, kFormAccuracy * light);
  constexpr double kForce = 300;  // [N]; deeper than 1 mm
  const double deep = kForce / DeepContactLaw(kBodyMass).stiffness;
  EXPECT_GT(deep, 1e-3);
  EXPECT_NEAR(DepthOnFloor(kForce, 1), deep, kFormAccuracy * deep);
}

// A critically damped spring under a constant force. In the first step, the ball does not yet touch
// the floor. Half a step of the simulation is 2.4 % of the time constant.
TEST(FloorContact, HasTheInertiaAndDampingOfItsLaw) {
  const ContactLaw law = LightContactLaw(kBodyMass);
  const double mass = kBodyMass + law.inertia, rest = 1 / law.stiffness;
  const double omega = std::sqrt(law.stiffness / mass);
  EXPECT_NEAR(law.damping / (2 * mass * omega), 1, 1e-12);
  for (const double time : {0.02, 0.04, 0.08}) {
    const double v = kOneStep / kBodyMass;  // after the first step, under 1 N
    const double y = v * kOneStep - rest, after = time - kOneStep;
    const double expected = rest + (y + (v + omega * y) * after) * std::exp(-omega * after);
    EXPECT_NEAR(DepthOnFloor(1, time), expected, 0.03 * rest) << time;
  }
}

// ---- a block on an incline ---------------------------------------------------------------------

TEST(Incline, ABlockSlidesAsFarAsFrictionLetsIt) {
  for (const FixtureShape shape : {FixtureShape::kPlane, FixtureShape::kBox}) {
    for (const double friction : {0.0, 0.1, 0.2, 0.3}) {
      FreeBody body(Shape::kBox, kBlock, {Slope(shape, friction)});
      body.Place(OnSlope(kBlock.z() / 2));
      body.Run(1);
      const double a = kGravity * (std::sin(kSlope) - friction * std::cos(kSlope));
      const double moved = (body.pose().p - OnSlope(kBlock.z() / 2).p).norm();
      EXPECT_NEAR(moved, a / 2, kFormAccuracy * a / 2) << friction;
      EXPECT_NEAR(body.velocity().norm(), a, kFormAccuracy * a) << friction;
    }
  }
}

TEST(Incline, ABlockRestsIfItsSlopeIsBelowTheFriction) {
  FreeBody body(Shape::kBox, kBlock, {Slope(FixtureShape::kPlane, 1.05 * std::tan(kSlope))});
  body.Place(OnSlope(kBlock.z() / 2));
  body.Run(2);
  EXPECT_LT((body.pose().p - OnSlope(kBlock.z() / 2).p).norm(), 1e-3);
  // The contact force must carry the weight.
  EXPECT_LT((body.ContactForce() - Vector3(0, 0, kBodyMass * kGravity)).norm(),
            kFormAccuracy * kBodyMass * kGravity);
  EXPECT_LT(body.Depth(), 1e-4);
}

// ---- a bouncing ball ---------------------------------------------------------------------------

TEST(Bounce, ABallReturnsTheShareOfItsSpeedThatTheDampingLeaves) {
  constexpr double kRadius = 0.2, kSpeed = 2;  // [m], [m/s]
  constexpr double kFrequency = 25;            // of the contact [rad/s]: it takes 126 steps
  for (const double zeta : {0.05, 0.1, 0.2}) {
    FixtureSpec ground = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
    ground.damping_ratio = zeta;
    ground.time_constant = 1 / (kFrequency * zeta);
    FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {ground}, 0);
    body.Place({kOrigin + Vector3(0, 0, kRadius + 0.01), Quaternion::Identity()}, {0, 0, -kSpeed});
    body.Run(0.4);
    const double e = Restitution(zeta);
    EXPECT_NEAR(body.velocity().z() / kSpeed, e, kFormAccuracy * e) << zeta;
  }
}

TEST(Bounce, AFallingBallRisesToTheHeightThatTheDampingLeaves) {
  constexpr double kRadius = 0.2, kSpeed = 2;              // [m], [m/s]
  constexpr double kFrequency = 100, kDamping = 0.05;      // of the contact [rad/s], [1]
  const double height = kSpeed * kSpeed / (2 * kGravity);  // [m]
  FixtureSpec ground = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
  ground.damping_ratio = kDamping;
  ground.time_constant = 1 / (kFrequency * kDamping);
  FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {ground});
  body.Place({kOrigin + Vector3(0, 0, kRadius + height), Quaternion::Identity()});
  body.Run(kSpeed / kGravity + 0.05);
  const double highest = body.Rise(0.3, kOrigin.z() + kRadius);
  const double e = Restitution(kDamping);
  EXPECT_NEAR(highest, e * e * height, kFormAccuracy * e * e * height);
  const double expected = HeightOfBounce(kFrequency, kDamping, kSpeed);
  EXPECT_NEAR(highest, expected, kFormAccuracy * expected);
}

TEST(Bounce, ACriticallyDampedContactDoesNotBounce) {
  constexpr double kRadius = 0.05;  // [m]
  FixtureSpec ground = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
  ground.time_constant = 0.02;  // so that the impact takes many steps
  FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {ground});
  body.Place({kOrigin + Vector3(0, 0, kRadius + 0.2), Quaternion::Identity()});
  body.Run(0.3);
  const double highest = body.Rise(0.3, kOrigin.z() + kRadius);
  EXPECT_LT(highest, 0.2 * 0.02);  // the limit of Restitution is exp(−2), so 1.8 % of the height
}

// The depth must not exceed the value in the documentation, which is 1.05 times the distance that
// the body moves in a step.
TEST(Bounce, AnImpactEntersAFixtureByLittleMoreThanItsSpeedTimesAStep) {
  constexpr int kPhases = 10;  // of the impact within a step
  FreeBody body(Shape::kBox, {0.2, 0.2, 0.1}, {Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin)},
                0);
  for (const double speed : {0.02, 0.05, 0.1, 0.2, 1.0}) {
    double deepest = 0;
    for (int phase = 0; phase < kPhases; ++phase) {
      const double gap = speed * (0.005 + kOneStep * phase / kPhases);  // [m]
      body.Place({kOrigin + Vector3(0, 0, 0.05 + gap), Quaternion::Identity()}, {0, 0, -speed});
      for (int k = 0; k < 50; ++k) {
        body.Run(kOneStep);
        deepest = std::max(deepest, body.Depth());
      }
    }
    EXPECT_GT(deepest, 0) << speed;
    EXPECT_LT(deepest, 1.05 * kOneStep * speed) << speed;
  }
}

// ---- a fixture with a stiffness ----------------------------------------------------------------

FixtureSpec YieldingGround(double stiffness, double damping) {
  FixtureSpec ground = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
  ground.stiffness = stiffness;
  ground.damping = damping;
  return ground;
}

// The engine scales its contacts with the masses of the bodies, but the contacts of a fixture with
// a stiffness must not depend on these masses.
TEST(Yielding, ABodySinksInByTheForceOverTheStiffnessOfItsPoints) {
  constexpr double kStiffness = 5000;  // [N/m]
  for (const Shape shape : {Shape::kSphere, Shape::kBox}) {
    const int points = shape == Shape::kSphere ? 1 : 4;
    for (const double force : {0.0, 50.0}) {
      FreeBody body(shape, {0.1, 0.1, 0.2}, {YieldingGround(kStiffness, 50)});
      body.Place({kOrigin + Vector3(0, 0, 0.1), Quaternion::Identity()});
      Wrench F = Wrench::Zero();
      F[2] = -force;
      body.Run(1.5, F);
      const double expected = (kBodyMass * kGravity + force) / (points * kStiffness);
      EXPECT_NEAR(kOrigin.z() + 0.1 - body.pose().p.z(), expected, 0.01 * expected)
          << points << " points, " << force << " N";
    }
  }
}

// Compares the motion at its turning points, where an error of half a step has little effect.
TEST(Yielding, ABodySwingsAsItsSpringAndDamperSay) {
  constexpr double kRadius = 0.1, kStiffness = 2000, kDamping = 12;  // [m], [N/m], [N·s/m]
  const double omega = std::sqrt(kStiffness / kBodyMass);
  const double zeta = kDamping / (2 * kBodyMass * omega);
  const double half = M_PI / (omega * std::sqrt(1 - zeta * zeta));  // half a period [s]
  const double rest = kRadius - kBodyMass * kGravity / kStiffness;
  constexpr double kDeeper = 0.004;  // at the start [m]
  FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {YieldingGround(kStiffness, kDamping)});
  body.Place({kOrigin + Vector3(0, 0, rest - kDeeper), Quaternion::Identity()});
  for (int k = 1; k <= 3; ++k) {
    const double before = std::round(1000 * (k - 1) * half), until = std::round(1000 * k * half);
    body.Run((until - before) / 1000);
    const double expected = (k % 2 == 1 ? 1 : -1) * std::exp(-zeta * omega * k * half);
    EXPECT_NEAR((body.pose().p.z() - kOrigin.z() - rest) / kDeeper, expected, kFormAccuracy) << k;
  }
}

// The ball moves under its weight. A fixture without a stiffness would compensate this weight
// during the impact. The heights differ by less than the distance of a step, so that the impacts
// begin at different phases of a step.
TEST(Yielding, AFallingBallRisesAsItsSpringAndDamperSay) {
  constexpr double kRadius = 0.2, kFrequency = 50;  // [m], of the contact [rad/s]
  for (const double zeta : {0.05, 0.1, 0.2}) {
    FreeBody body(
        Shape::kSphere, {kRadius, 0, 0},
        {YieldingGround(kBodyMass * kFrequency * kFrequency, 2 * zeta * kBodyMass * kFrequency)});
    for (const double height : {0.8155, 0.8163, 0.8171, 0.8179}) {
      const double speed = std::sqrt(2 * kGravity * height);
      body.Place({kOrigin + Vector3(0, 0, kRadius + height), Quaternion::Identity()});
      body.Run(speed / kGravity + 0.05);
      const double expected = HeightOfBounce(kFrequency, zeta, speed);
      EXPECT_NEAR(body.Rise(0.5, kOrigin.z() + kRadius), expected, kFormAccuracy * expected)
          << zeta << ' ' << height;
    }
  }
}

// ---- a sliding stop ----------------------------------------------------------------------------

TEST(SlidingStop, ABlockStopsAfterTheDistanceOfItsFriction) {
  // Each stop takes at least 25 steps, because shorter stops depend on the time constant of the
  // friction.
  const std::pair<double, double> stops[] = {{0.3, 0.1}, {0.3, 0.2}, {0.3, 0.5}, {0.3, 1.5},
                                             {0.8, 0.2}, {0.8, 0.5}, {0.8, 1.5}};
  for (const auto& [friction, speed] : stops) {
    FreeBody body(Shape::kBox, kBlock, {TableTop(friction)});
    const Vector3 start = kOrigin + Vector3(0, 0, kBlock.z() / 2);
    body.Place({start, Quaternion::Identity()}, {speed, 0, 0});
    body.Run(speed / (friction * kGravity) + 0.3);
    const double expected = speed * speed / (2 * friction * kGravity);
    EXPECT_NEAR((body.pose().p - start).x(), expected, kFormAccuracy * expected)
        << friction << ' ' << speed;
    EXPECT_LT(body.velocity().norm(), 1e-4);
    EXPECT_LT(body.Depth(), 1e-4);
  }
}

// ---- a tipping box -----------------------------------------------------------------------------

// A force at the height of the centre of mass, h/2, tips a box of width w if it exceeds m g w / h.
TEST(Tipping, ABoxTipsAtTheForceThatMovesItsWeightOverTheEdge) {
  const Vector3 size = {0.1, 0.2, 0.3};
  const double critical = kBodyMass * kGravity * size.x() / size.z();
  for (const double share : {1 - kFormAccuracy, 1 + kFormAccuracy}) {
    FreeBody body(Shape::kBox, size, {TableTop(0.8)});
    body.Place({kOrigin + Vector3(0, 0, size.z() / 2), Quaternion::Identity()});
    body.Run(0.5);
    Wrench F = Wrench::Zero();
    F[0] = share * critical;
    body.Run(2, F);
    EXPECT_EQ(body.tilt() > 0.3, share > 1) << body.tilt();
    EXPECT_EQ(body.tilt() < 0.01, share < 1) << body.tilt();
  }
}

// ---- a peg against a wall ----------------------------------------------------------------------

// A force N presses the end face of a peg, which lies along x, against a wall. The wall reacts with
// N, and its friction either holds the peg or lets it slide down with the acceleration g − μ N / m.
TEST(Peg, SlidesDownAWallAgainstTheFrictionOfThePressingForce) {
  constexpr double kFriction = 0.5, kRadius = 0.05, kLength = 0.04;
  FixtureSpec wall = Fixture(FixtureShape::kBox, {0.1, 2, 8}, kOrigin + Vector3(0.05, 0, 0));
  wall.friction = kFriction;
  for (const double force : {20.0, 30.0, 60.0}) {
    FreeBody body(Shape::kCylinder, {kRadius, kLength, 0}, {wall});
    const Pose start = PoseFromXyzRpy(kOrigin - Vector3(kLength / 2, 0, 0), {0, M_PI / 2, 0});
    body.Place(start);
    Wrench F = Wrench::Zero();
    F[0] = force;
    body.Run(0.5, F);
    EXPECT_NEAR(-body.ContactForce().x(), force, kFormAccuracy * force);
    const double a = std::max(0.0, kGravity - kFriction * force / kBodyMass);
    if (a == 0) {
      EXPECT_LT(body.Depth(), 1e-4);
    }
    const double expected = a * 0.5 * 0.5 / 2;
    EXPECT_NEAR(start.p.z() - body.pose().p.z(), expected, std::max(kFormAccuracy * expected, 1e-3))
        << force;
  }
}

}  // namespace
}  // namespace predictor
