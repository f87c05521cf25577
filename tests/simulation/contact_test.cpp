// Compares contacts of a free body and fixtures with closed forms of rigid bodies with Coulomb
// friction.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.h"
#include "simulation/engine.h"

namespace predictor {
namespace {

constexpr double kOneStep = 1e-3;   // [s]
constexpr double kAccuracy = 0.02;  // of a closed form, relative
constexpr double kBodyMass = 2;     // [kg]

FixtureSpec Fixture(FixtureShape shape, const Vector3& size, const Vector3& xyz,
                    const Vector3& rpy = Vector3::Zero()) {
  FixtureSpec fixture;
  fixture.shape = shape;
  fixture.size = size;
  fixture.xyz = xyz;
  fixture.rpy = rpy;
  return fixture;
}

// A free body among fixtures; the cobot is there, but does not touch it.
class FreeBody {
 public:
  FreeBody(Shape shape, const Vector3& size, const std::vector<FixtureSpec>& fixtures,
           double gravity = kGravity)
      : FreeBody([&] {
          Scenario s = PandaScene();
          s.object.primitive = PrimitiveSpec{};
          s.object.primitive->shape = shape;
          s.object.primitive->size = size;
          s.object.primitive->mass = kBodyMass;
          s.environment.fixtures = fixtures;
          s.environment.gravity = gravity;
          return s;
        }()) {}

  void Place(const Pose& X, const Vector3& v = Vector3::Zero()) {
    FrameMotion O;
    O.X_W = X;
    O.V_W.head<3>() = v;
    engine_->MoveObject(O);
    ASSERT_TRUE(engine_->Prepare());
  }
  // Under the wrench F; sums the contacts' forces.
  void Run(double duration, const Wrench& F = Wrench::Zero()) {
    engine_->SetObjectWrench(F);
    const int steps = static_cast<int>(std::lround(duration / kOneStep));
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < steps; ++k) {
      ASSERT_TRUE(engine_->Advance());
      for (int i = 0; i < engine_->contact_count(); ++i) sum += engine_->contact(i).force_W;
      ASSERT_TRUE(engine_->Prepare());
    }
    mean_force_ = sum / steps;
  }
  Pose pose() const { return engine_->PoseOf(SceneBody::kObject); }
  Vector3 velocity() const { return engine_->MotionOf(SceneBody::kObject).V_W.head<3>(); }

  // Mean of the contacts' forces in the last Run: a sliding body hops. Greatest penetration.
  const Vector3& ContactForce() const { return mean_force_; }
  double Depth() const {
    double depth = 0;
    for (int i = 0; i < engine_->contact_count(); ++i)
      depth = std::max(depth, engine_->contact(i).depth);
    return depth;
  }

 private:
  explicit FreeBody(const Scenario& s)
      : robot_(RobotModel::Load(
            {s.cobot.model, s.folder(), s.cobot.remove_links, s.cobot.base.ToPose(), "cobot"})),
        engine_(MakeEngine(s, *robot_, false, Holding::kFree)) {}

  std::shared_ptr<const RobotModel> robot_;
  std::unique_ptr<Engine> engine_;
  Vector3 mean_force_ = Vector3::Zero();
};

// ---- a block on an incline ---------------------------------------------------------------------

constexpr double kSlope = 20 * M_PI / 180;  // [rad]; its tangent is 0.364
const Vector3 kBlock = {0.2, 0.2, 0.1};     // [m]
const Vector3 kOrigin = {2, 0, 1};          // out of the cobot's reach [m]

// A slope through kOrigin that falls along x, as a plane or as the upper face of a box.
FixtureSpec Slope(FixtureShape shape, double friction) {
  const Pose X = PoseFromXyzRpy(kOrigin, {0, kSlope, 0});
  const bool plane = shape == FixtureShape::kPlane;
  FixtureSpec slope =
      Fixture(shape, {6, 1, plane ? 0 : 0.1}, X * Vector3(0, 0, plane ? 0 : -0.05), {0, kSlope, 0});
  slope.friction = friction;
  return slope;
}

Pose OnSlope(double height) {
  const Pose X = PoseFromXyzRpy(kOrigin, {0, kSlope, 0});
  return {X * Vector3(0, 0, height), X.q};
}

TEST(Incline, ABlockSlidesAsFarAsFrictionLetsIt) {
  for (const FixtureShape shape : {FixtureShape::kPlane, FixtureShape::kBox}) {
    for (const double friction : {0.0, 0.1, 0.2, 0.3}) {
      FreeBody body(Shape::kBox, kBlock, {Slope(shape, friction)});
      body.Place(OnSlope(kBlock.z() / 2));
      body.Run(1);
      const double a = kGravity * (std::sin(kSlope) - friction * std::cos(kSlope));
      const double moved = (body.pose().p - OnSlope(kBlock.z() / 2).p).norm();
      EXPECT_NEAR(moved, a / 2, kAccuracy * a / 2) << friction;
      EXPECT_NEAR(body.velocity().norm(), a, kAccuracy * a) << friction;
    }
  }
}

TEST(Incline, ABlockRestsIfItsSlopeIsBelowTheFriction) {
  FreeBody body(Shape::kBox, kBlock, {Slope(FixtureShape::kPlane, 1.05 * std::tan(kSlope))});
  body.Place(OnSlope(kBlock.z() / 2));
  body.Run(2);
  EXPECT_LT((body.pose().p - OnSlope(kBlock.z() / 2).p).norm(), 1e-3);
  // The slope carries the weight.
  EXPECT_LT((body.ContactForce() - Vector3(0, 0, kBodyMass * kGravity)).norm(),
            kAccuracy * kBodyMass * kGravity);
  EXPECT_LT(body.Depth(), 1e-4);
}

// ---- a bouncing ball ---------------------------------------------------------------------------

// A linear spring and damper that pushes but does not pull returns the share e of the speed
// (Schwager & Pöschel, Granular Matter 9:465, 2007, eq. 20).
double Restitution(double zeta) {
  const double omega = std::sqrt(1 - zeta * zeta);  // in units of the undamped one
  const double angle = std::atan2(2 * zeta * omega, omega * omega - zeta * zeta);
  return std::exp(-zeta / omega * (M_PI - angle));
}

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
    EXPECT_NEAR(body.velocity().z() / kSpeed, e, kAccuracy * e) << zeta;
  }
}

// Height above the contact at which a ball that arrives at the speed v turns again [m]: the same
// spring and damper, and the weight, integrated in small steps.
double HeightOfBounce(double omega, double zeta, double v) {
  constexpr double kSmallStep = 1e-6;  // [s]
  double z = 0, speed = -v;
  for (;;) {
    const double push = -omega * omega * z - 2 * zeta * omega * speed;
    if (push < 0) return z + speed * speed / (2 * kGravity);
    speed += kSmallStep * (push - kGravity);
    z += kSmallStep * speed;
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
  double highest = 0;
  for (int k = 0; k < 300; ++k) {
    body.Run(kOneStep);
    highest = std::max(highest, body.pose().p.z() - kOrigin.z() - kRadius);
  }
  const double e = Restitution(kDamping);
  EXPECT_NEAR(highest, e * e * height, kAccuracy * e * e * height);
  const double expected = HeightOfBounce(kFrequency, kDamping, kSpeed);
  EXPECT_NEAR(highest, expected, kAccuracy * expected);
}

TEST(Bounce, ACriticallyDampedContactDoesNotBounce) {
  constexpr double kRadius = 0.05;  // [m]
  FixtureSpec ground = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
  ground.time_constant = 0.02;  // so that the impact takes many steps
  FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {ground});
  body.Place({kOrigin + Vector3(0, 0, kRadius + 0.2), Quaternion::Identity()});
  body.Run(0.3);
  double highest = -1;
  for (int k = 0; k < 300; ++k) {
    body.Run(kOneStep);
    highest = std::max(highest, body.pose().p.z() - kOrigin.z() - kRadius);
  }
  EXPECT_LT(highest, 0.2 * 0.02);  // the limit of Restitution is exp(−2), so 1.8 % of the height
}

// The depth is what the documentation states: the distance of a step, and 5 % more.
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

// The engine scales its contacts to the masses of the bodies; these must not depend on them.
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

// At its turning points, so that half a step does not matter.
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
    EXPECT_NEAR((body.pose().p.z() - kOrigin.z() - rest) / kDeeper, expected, kAccuracy) << k;
  }
}

// ---- a sliding stop ----------------------------------------------------------------------------

TEST(SlidingStop, ABlockStopsAfterTheDistanceOfItsFriction) {
  for (const double speed : {0.1, 0.2, 0.5, 1.5}) {
    FixtureSpec table = Fixture(FixtureShape::kBox, {4, 1, 0.1}, kOrigin - Vector3(0, 0, 0.05));
    table.friction = 0.3;
    FreeBody body(Shape::kBox, kBlock, {table});
    const Vector3 start = kOrigin + Vector3(0, 0, kBlock.z() / 2);
    body.Place({start, Quaternion::Identity()}, {speed, 0, 0});
    body.Run(speed / (0.3 * kGravity) + 0.3);
    const double expected = speed * speed / (2 * 0.3 * kGravity);
    EXPECT_NEAR((body.pose().p - start).x(), expected, kAccuracy * expected);
    EXPECT_LT(body.velocity().norm(), 1e-4);
    EXPECT_LT(body.Depth(), 1e-4);
  }
}

// ---- a tipping box -----------------------------------------------------------------------------

// A force at the height of the centre of mass, h/2, tips a box of width w if it exceeds m g w / h.
TEST(Tipping, ABoxTipsAtTheForceThatMovesItsWeightOverTheEdge) {
  const Vector3 size = {0.1, 0.2, 0.3};
  const double critical = kBodyMass * kGravity * size.x() / size.z();
  for (const double share : {1 - kAccuracy, 1 + kAccuracy}) {
    FixtureSpec table = Fixture(FixtureShape::kBox, {4, 1, 0.1}, kOrigin - Vector3(0, 0, 0.05));
    table.friction = 0.8;
    FreeBody body(Shape::kBox, size, {table});
    body.Place({kOrigin + Vector3(0, 0, size.z() / 2), Quaternion::Identity()});
    body.Run(0.5);
    Wrench F = Wrench::Zero();
    F[0] = share * critical;
    body.Run(2, F);
    const double tilt = std::acos(std::min(1.0, body.pose().R()(2, 2)));
    EXPECT_EQ(tilt > 0.3, share > 1) << tilt;
    EXPECT_EQ(tilt < 0.01, share < 1) << tilt;
  }
}

// ---- a peg against a wall ----------------------------------------------------------------------

// A peg along x, with an end face against a wall, pressed by a force N: the wall answers with N,
// and its friction lets the peg slide down with g − μ N / m, or holds it.
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
    EXPECT_NEAR(-body.ContactForce().x(), force, kAccuracy * force);
    const double a = std::max(0.0, kGravity - kFriction * force / kBodyMass);
    if (a == 0) {
      EXPECT_LT(body.Depth(), 1e-4);
    }
    const double expected = a * 0.5 * 0.5 / 2;
    EXPECT_NEAR(start.p.z() - body.pose().p.z(), expected, std::max(kAccuracy * expected, 1e-3))
        << force;
  }
}

}  // namespace
}  // namespace predictor
