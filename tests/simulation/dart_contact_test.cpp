// Tests contact in the engine DART. The tests cover contact with fixtures, the scenarios that DART
// refuses, and the differences from MuJoCo.
#include <array>
#include <string>
#include <vector>

#include "core/error.h"
#include "free_body.h"
#include "simulation/dart/dart_process.h"
#include "simulation/dart/dart_scene.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

FreeBody InDart(Shape shape, const Vector3& size, const std::vector<FixtureSpec>& fixtures,
                double gravity = kGravity) {
  return FreeBody(shape, size, fixtures, gravity, EngineKind::kDart);
}

// A build without DART skips these tests.
class DartContact : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasDart()) GTEST_SKIP() << "This build has no DART.";
  }
};

// ---- shapes ------------------------------------------------------------------------------------

struct Support {
  const char* name;
  FixtureSpec fixture;  // its top is at kOrigin
};

std::vector<Support> Supports() {
  const auto below = [](double depth) -> Vector3 { return kOrigin - Vector3(0, 0, depth); };
  return {{"plane", Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin)},
          {"box", Fixture(FixtureShape::kBox, {1, 1, 0.2}, below(0.1))},
          {"cylinder", Fixture(FixtureShape::kCylinder, {0.3, 0.2, 0}, below(0.1))}};
}

// Each shape must rest on each flat top and must sink into it by less than 1 µm.
TEST_F(DartContact, EveryShapeRestsOnEveryFlatTop) {
  const std::array<std::pair<Shape, Vector3>, 3> shapes = {{{Shape::kBox, {0.2, 0.2, 0.2}},
                                                            {Shape::kCylinder, {0.1, 0.2, 0}},
                                                            {Shape::kSphere, {0.1, 0, 0}}}};
  for (const Support& support : Supports()) {
    for (const auto& [shape, size] : shapes) {
      FreeBody body = InDart(shape, size, {support.fixture});
      const Vector3 start = kOrigin + Vector3(0, 0, 0.1);
      body.Place({start, Quaternion::Identity()});
      body.Run(0.3);
      const int kind = static_cast<int>(shape);
      EXPECT_LT((body.pose().p - start).norm(), 1e-6) << support.name << ' ' << kind;
      EXPECT_LT(body.tilt(), 1e-5) << support.name << ' ' << kind;
      EXPECT_NEAR(body.ContactForce().z(), kBodyMass * kGravity, 0.01 * kBodyMass * kGravity);
      ASSERT_GT(body.engine().contact_count(), 0);
      EXPECT_EQ(body.engine().contact(0).fixture, 0);
      EXPECT_GT(body.engine().contact(0).normal_W.z(), 0.999);
    }
  }
}

// The cylinder has a moment of inertia of m r²/2, so it rolls at two thirds of the speed at which
// it slid. Points of contact from earlier steps must not hold the cylinder back.
TEST_F(DartContact, ACylinderThatSlidesBeginsToRoll) {
  FreeBody body = InDart(Shape::kCylinder, {0.05, 0.2, 0}, {TableTop(0.5)});
  body.Place(
      {kOrigin + Vector3(0, 0, 0.05), Quaternion(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitX()))},
      {1, 0, 0});
  body.Run(1);
  EXPECT_NEAR(body.velocity().x(), 2.0 / 3, kFormAccuracy * 2 / 3);
}

// A cylinder at the edge of a table must stand as long as its centre is above the table.
TEST_F(DartContact, ACylinderTipsOverAnEdgeIfItsCentreIsBeyondIt) {
  for (const double beyond : {-0.01, 0.01}) {
    FixtureSpec table = Fixture(FixtureShape::kBox, {2, 2, 0.1}, kOrigin - Vector3(1, 0, 0.05));
    table.friction = 0.8;
    FreeBody body = InDart(Shape::kCylinder, {0.05, 0.2, 0}, {table});
    body.Place({kOrigin + Vector3(beyond, 0, 0.1), Quaternion::Identity()});
    body.Run(1);
    EXPECT_EQ(body.tilt() < 1e-3, beyond < 0) << body.tilt();
    EXPECT_EQ(body.tilt() > 0.3, beyond > 0) << body.tilt();
  }
}

// The body touches a capsule or a ball from the side, at a single point.
TEST_F(DartContact, CapsulesAndBallsStopABody) {
  for (const FixtureShape shape : {FixtureShape::kCapsule, FixtureShape::kSphere}) {
    const double radius = 0.1;
    const FixtureSpec post = Fixture(shape, {radius, 0.4, 0}, kOrigin);
    for (const Shape moving : {Shape::kBox, Shape::kSphere, Shape::kCylinder}) {
      const Vector3 size = moving == Shape::kBox ? Vector3(0.2, 0.2, 0.2) : Vector3(0.1, 0.2, 0);
      FreeBody body = InDart(moving, size, {post}, 0);
      body.Place({kOrigin - Vector3(0.5, 0, 0), Quaternion::Identity()}, {0.5, 0, 0});
      double farthest = -HUGE_VAL;
      for (int k = 0; k < 1500; ++k) {
        body.Run(kOneStep);
        farthest = std::max(farthest, body.pose().p.x() - kOrigin.x());
      }
      EXPECT_NEAR(farthest, -radius - 0.1, 1e-3)
          << static_cast<int>(shape) << static_cast<int>(moving);
    }
  }
}

// ---- impact and friction -----------------------------------------------------------------------

// Returns the speed [m/s] at which a mass of 1 kg that arrives at 1 m/s leaves a spring of 1 N/m
// with this damping ratio.
double ShareOfSpeed(double zeta) {
  constexpr double kSmallStep = 1e-5;  // [s]
  double x = 0, v = -1;
  for (;;) {
    const double a = -x - 2 * zeta * v;
    if (a < 0) return v;
    v += kSmallStep * a;
    x += kSmallStep * v;
  }
}

TEST(RestitutionOf, IsThatOfASpringAndDamper) {
  for (const double zeta : {0.0, 0.05, 0.5, 0.9, 0.99, 1.0, 1.01, 1.5, 3.0})
    EXPECT_NEAR(RestitutionOf(zeta), ShareOfSpeed(zeta), 1e-4) << zeta;
}

// DART limits the friction along each of two axes. Along the diagonal between these axes, the
// friction is therefore √2 times as large.
TEST_F(DartContact, FrictionDependsOnTheDirection) {
  constexpr double kFriction = 0.3, kSpeed = 0.5;  // [1], [m/s]
  const double path = kSpeed * kSpeed / (2 * kFriction * kGravity);
  for (const double direction : {0.0, M_PI / 4}) {
    FreeBody body = InDart(Shape::kBox, kBlock, {TableTop(kFriction)});
    const Vector3 start = kOrigin + Vector3(0, 0, kBlock.z() / 2);
    body.Place({start, Quaternion::Identity()},
               kSpeed * Vector3(std::cos(direction), std::sin(direction), 0));
    body.Run(1);
    const double expected = direction == 0 ? path : path / std::sqrt(2);
    EXPECT_NEAR((body.pose().p - start).norm(), expected, kFormAccuracy * expected) << direction;
  }
}

TEST_F(DartContact, ARemovedFixtureDoesNotTouch) {
  FreeBody body = InDart(Shape::kBox, kBlock, {Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin)});
  const Vector3 start = kOrigin + Vector3(0, 0, kBlock.z() / 2);
  body.Place({start, Quaternion::Identity()});
  body.engine().RemoveFixtures(1);
  ASSERT_TRUE(body.engine().Prepare());
  body.Run(0.1);
  EXPECT_NEAR(start.z() - body.pose().p.z(), kGravity * 0.1 * 0.1 / 2, 1e-3);
  EXPECT_EQ(body.engine().contact_count(), 0);
  body.engine().RemoveFixtures(0);
  ASSERT_TRUE(body.engine().Prepare());
  EXPECT_GT(body.engine().contact_count(), 0);  // it is inside now
}

// ---- in the world ------------------------------------------------------------------------------

constexpr double kWallGap = 0.03;  // [m]

// Returns a scenario with a wall in front of the box that the cobot holds, at a distance of
// kWallGap.
Scenario BeforeAWall() {
  Scenario s = BoxScene(9);
  s.simulation.engine = EngineKind::kDart;
  s.object.attachment.joint = JointType::kFixed;
  s.object.attachment.on_end_effector.rpy.z() = -0.785;  // its faces are along the axes of W
  const World free(s);
  FixtureSpec wall;
  wall.size = {0.1, 2, 2};
  wall.xyz = free.state().object.X_W.p + Vector3(0.13 + kWallGap + 0.05, 0, 0);
  s.environment.fixtures = {wall};
  return s;
}

TEST_F(DartContact, AWallStopsTheBoxThatIsPushedIntoIt) {
  const Scenario s = BeforeAWall();
  World world(s);
  const double start = world.state().object.X_W.p.x();
  Simulate(&world, Push(s, {15, 0, 0}), 1.5);
  EXPECT_NEAR(world.state().object.X_W.p.x() - start, kWallGap, 2e-3);
}

// The points of contact are not part of the saved state, so the engine must not use points of
// contact from earlier steps.
TEST_F(DartContact, ContinuesARestoredStateBitForBit) {
  const Scenario s = BeforeAWall();
  const WorldInput input = Push(s, {15, 4, -3});
  World world(s), other(s);
  Simulate(&world, input, 0.8);
  Simulate(&other, Push(s, {15, -8, 8}), 1);  // touches the wall elsewhere
  std::vector<std::byte> bytes(1 << 16);
  StateArchive save = StateArchive::ToSave(bytes);
  world.Archive(save);
  ASSERT_TRUE(save.ok());
  StateArchive load = StateArchive::ToLoad(std::span(bytes).first(save.used()));
  other.Archive(load);
  ASSERT_TRUE(load.ok());
  for (int i = 0; i < 300; ++i) {
    Simulate(&world, input, kTick);
    Simulate(&other, input, kTick);
    ASSERT_EQ(world.state().q, other.state().q) << i;
    ASSERT_EQ(world.state().object.V_W, other.state().object.V_W) << i;
  }
}

// ---- what it refuses ---------------------------------------------------------------------------

TEST_F(DartContact, RefusesByNameWhatARigidContactCannotDo) {
  const Scenario s = BeforeAWall();
  const auto refusal = [&s](auto change) {
    Scenario changed = s;
    change(&changed.environment.fixtures[0]);
    return RefusalOf(changed);
  };
  EXPECT_EQ(refusal([](FixtureSpec* f) { f->stiffness = 5000; }),
            "environment.fixtures.0.stiffness | environment.fixtures.0.stiffness is given, but "
            "simulation.engine is dart, whose contacts are rigid. Remove stiffness and damping, or "
            "set simulation.engine: mujoco.");
  EXPECT_EQ(refusal([](FixtureSpec* f) { f->time_constant = 0.02; }),
            "environment.fixtures.0.time_constant | environment.fixtures.0.time_constant is "
            "given, but simulation.engine is dart, whose contacts are rigid. Remove "
            "time_constant, or set simulation.engine: mujoco.");
  EXPECT_EQ(refusal([](FixtureSpec* f) {
              f->touches = {"object", "cobot"};
            }),
            "environment.fixtures.0.touches | environment.fixtures.0.touches contains cobot, but "
            "simulation.engine is dart, in which only the object touches fixtures. Remove cobot "
            "from touches, or set simulation.engine: mujoco.");
  EXPECT_EQ(refusal([](FixtureSpec* f) { f->keep_out = true; }),
            "environment.fixtures.0.keep_out | environment.fixtures.0.keep_out is true, but "
            "simulation.engine is dart, in which the cobot touches no fixtures. Remove the "
            "fixture, or set simulation.engine: mujoco.");
  Scenario own = s;
  own.cobot.touches = {"object"};
  EXPECT_EQ(RefusalOf(own),
            "cobot.touches | cobot.touches is given, but simulation.engine is dart, in which the "
            "cobot's links collide with nothing. Remove cobot.touches, or set simulation.engine: "
            "mujoco.");
  EXPECT_EQ(refusal([](FixtureSpec* f) { f->xyz.x() -= kWallGap + 0.0005; }),
            "simulation.engine | simulation.engine is dart, but the object touches the floor, the "
            "table or a fixture at the start. Lift the object by a change of cobot.posture, or set "
            "simulation.engine: mujoco.");
}

}  // namespace
}  // namespace predictor
