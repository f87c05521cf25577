// Compares movable objects that touch each other or fixtures with closed forms of mechanics. The
// scene contains a cobot, which touches nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenes.h"
#include "simulation/engine.h"

namespace predictor {
namespace {

constexpr double kOneStep = 1e-3;  // [s]
constexpr double kSide = 0.1;      // of a cube [m]
const Vector3 kPlace = {3, 0, 0};  // out of the cobot's reach [m]

MovableSpec Cube(const std::string& name, double mass, const Vector3& offset) {
  MovableSpec cube;
  cube.name = name;
  cube.primitive = PrimitiveSpec{};
  cube.primitive->size = Vector3::Constant(kSide);
  cube.primitive->mass = mass;
  cube.xyz = kPlace + offset;
  return cube;
}

// Returns a table whose top is at z = 0.
FixtureSpec Table(double friction) {
  FixtureSpec table;
  table.size = {4, 4, 0.2};
  table.xyz = kPlace - Vector3(0, 0, 0.1);
  table.friction = friction;
  return table;
}

class Bench {
 public:
  Bench(const std::vector<MovableSpec>& objects, const std::vector<FixtureSpec>& fixtures,
        double gravity = kGravity) {
    Scenario s = PandaScene();
    s.object.primitive = PrimitiveSpec{};
    s.environment.gravity = gravity;
    s.environment.objects = objects;
    s.environment.fixtures = fixtures;
    robot_ = RobotModel::Load(
        {s.cobot.model, s.folder(), s.cobot.remove_links, s.cobot.base.ToPose(), "cobot"});
    engine_ = MakeEngine(s, *robot_, false, Holding::kFree);
    EXPECT_TRUE(engine_->Prepare());
  }

  Engine& engine() { return *engine_; }
  MovableMotion motion(std::size_t i) const { return engine_->movables().motion[i]; }
  void Throw(std::size_t i, const Vector3& v) {
    engine_->movable_velocities().segment<3>(static_cast<Eigen::Index>(6 * i)) = v;
    ASSERT_TRUE(engine_->Prepare());
  }
  // Returns the mean upward force that the contacts with another body exert on `body` during the
  // run [N]. `by` is the number of the other body, or −1 for the fixture.
  double Run(double duration, int body = -1, int by = -1) {
    const int steps = static_cast<int>(std::lround(duration / kOneStep));
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
      EXPECT_TRUE(engine_->Advance());
      for (int i = 0; i < engine_->contact_count(); ++i) {
        const Contact contact = engine_->contact(i);
        if (contact.body == body && contact.movable == by) sum += contact.force_W.z();
        if (by >= 0 && contact.body == by && contact.movable == body) sum -= contact.force_W.z();
      }
      EXPECT_TRUE(engine_->Prepare());
    }
    return sum / steps;
  }

 private:
  std::shared_ptr<const RobotModel> robot_;
  std::unique_ptr<Engine> engine_;
};

TEST(Movables, BeginWhereTheScenarioSays) {
  MovableSpec cube = Cube("a", 1, {0, 0, 1});
  cube.rpy = {0.3, -0.2, 0.5};
  Bench bench({cube, Cube("b", 1, {1, 0, 2})}, {});
  ASSERT_EQ(bench.engine().movables().count, 2);
  EXPECT_LT((bench.motion(0).X_W.p - cube.xyz).norm(), 1e-12);
  EXPECT_LT(RotationError(bench.motion(0).X_W.q, cube.X_WM().q).norm(), 1e-12);
  EXPECT_LT((bench.motion(1).X_W.p - Vector3(4, 0, 2)).norm(), 1e-12);
}

// The engine's steps are semi-implicit: after n steps, the fall is g dt² n (n + 1)/2.
TEST(Movables, FallFreely) {
  Bench bench({Cube("a", 1, {0, 0, 2})}, {});
  bench.Run(0.5);
  EXPECT_NEAR(bench.motion(0).X_W.p.z(), 2 - kGravity * kOneStep * kOneStep * 500 * 501 / 2, 1e-9);
  EXPECT_NEAR(bench.motion(0).V_W.z(), -kGravity * 0.5, 1e-9);
}

TEST(Movables, AFallEndsBelowTheScene) {
  Bench bench({Cube("a", 1, {0, 0, 2})}, {});
  bench.Run(3);
  EXPECT_EQ(bench.motion(0).X_W.p.z(), -20);
  EXPECT_LT(bench.motion(0).V_W.norm(), kGravity * 2 * kOneStep);
}

// Each contact must carry the weight of everything above it.
TEST(Movables, AStackStandsAndItsContactsCarryTheWeights) {
  constexpr double kMasses[] = {3, 2, 0.5};
  std::vector<MovableSpec> cubes;
  for (int i = 0; i < 3; ++i)
    cubes.push_back(Cube("c" + std::to_string(i), kMasses[i], {0, 0, (i + 0.5) * kSide}));
  for (int above = 0; above < 3; ++above) {
    Bench bench(cubes, {Table(0.5)});
    bench.Run(1);
    const double force = bench.Run(0.5, above, above - 1);
    double weight = 0;
    for (int i = above; i < 3; ++i) weight += kMasses[i] * kGravity;
    EXPECT_NEAR(force, weight, 0.01 * weight) << above;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT((bench.motion(i).X_W.p - cubes[i].xyz).norm(), 1e-4);
      EXPECT_LT(bench.motion(i).V_W.norm(), 1e-4);
    }
  }
}

// A sliding block stops after v²/(2 μ g).
TEST(Movables, ABlockSlidesToAStop) {
  constexpr double kSpeed = 1, kSliding = 0.3;
  Bench bench({Cube("a", 2, {-0.5, 0, kSide / 2})}, {Table(kSliding)});
  bench.Throw(0, {kSpeed, 0, 0});
  bench.Run(1);
  const double path = kSpeed * kSpeed / (2 * kSliding * kGravity);
  EXPECT_NEAR(bench.motion(0).X_W.p.x() - (kPlace.x() - 0.5), path, 0.02 * path);
}

// If two bodies have different friction coefficients, the lower one applies to their contact.
TEST(Movables, ASlipperyBlockSlidesFarther) {
  constexpr double kSpeed = 1;
  for (const auto& [of_table, of_block] : {std::pair{0.6, 0.3}, std::pair{0.3, 0.6}}) {
    MovableSpec block = Cube("a", 2, {-0.5, 0, kSide / 2});
    block.friction = of_block;
    Bench bench({block}, {Table(of_table)});
    bench.Throw(0, {kSpeed, 0, 0});
    bench.Run(1);
    const double path = kSpeed * kSpeed / (2 * 0.3 * kGravity);
    EXPECT_NEAR(bench.motion(0).X_W.p.x() - (kPlace.x() - 0.5), path, 0.02 * path);
  }
}

// Two cubes collide in free space. The total momentum of the cubes must be conserved, and the
// contact must not add energy.
TEST(Movables, AnImpactConservesMomentum) {
  constexpr double kFast = 0.8, kSlow = -0.3, kHeavy = 3, kLight = 1;
  Bench bench({Cube("a", kHeavy, {-0.2, 0, 0}), Cube("b", kLight, {0.2, 0, 0})}, {}, 0);
  bench.Throw(0, {kFast, 0, 0});
  bench.Throw(1, {kSlow, 0, 0});
  bench.Run(1);
  const Vector3 a = bench.motion(0).V_W.head<3>(), b = bench.motion(1).V_W.head<3>();
  const double momentum = kHeavy * kFast + kLight * kSlow;
  EXPECT_NEAR(kHeavy * a.x() + kLight * b.x(), momentum, 1e-9);
  EXPECT_NEAR(kHeavy * a.y() + kLight * b.y(), 0, 1e-9);
  const double energy = kHeavy * a.x() * a.x() + kLight * b.x() * b.x();
  EXPECT_LT(energy, 0.9 * (kHeavy * kFast * kFast + kLight * kSlow * kSlow));
  EXPECT_GE(energy, momentum * momentum / (kHeavy + kLight) * (1 - 1e-9));
  EXPECT_GE(b.x(), a.x());  // they do not pass through each other
  EXPECT_GT(bench.motion(1).X_W.p.x() - bench.motion(0).X_W.p.x(), kSide - 1e-3);
}

// The lower of two stacked blocks is thrown. While both slide, the upper block is accelerated by μ
// g, and the friction of both of its faces decelerates the lower one.
TEST(Movables, TwoBlocksThatSlideOnEachOtherFollowCoulombsLaw) {
  constexpr double kSpeed = 1.5, kTime = 0.3;  // [m/s], [s]
  constexpr double kTop = 0.2, kBottom = 0.1;  // friction
  constexpr double kUpper = 1, kLower = 2;     // [kg]
  MovableSpec lower = Cube("lower", kLower, {-0.5, 0, kSide / 2});
  MovableSpec upper = Cube("upper", kUpper, {-0.5, 0, 1.5 * kSide});
  lower.primitive->size = {3, 0.4, kSide};
  upper.friction = kTop;
  Bench bench({lower, upper}, {Table(kBottom)});
  bench.Run(0.1);
  const double before = bench.motion(1).X_W.p.x();
  bench.Throw(0, {kSpeed, 0, 0});
  bench.Run(kTime);
  const double of_upper = kTop * kGravity;
  const double of_lower = (kBottom * (kUpper + kLower) + kTop * kUpper) * kGravity / kLower;
  ASSERT_GT(kSpeed - of_lower * kTime, of_upper * kTime);  // they still slide
  EXPECT_NEAR(bench.motion(1).V_W.x(), of_upper * kTime, 0.02 * of_upper * kTime);
  EXPECT_NEAR(bench.motion(0).V_W.x(), kSpeed - of_lower * kTime, 0.02 * of_lower * kTime);
  const double path = of_upper * kTime * kTime / 2;
  EXPECT_NEAR(bench.motion(1).X_W.p.x() - before, path, 0.02 * path);
}

TEST(Movables, TheirWeightHasAPotential) {
  constexpr double kCubeMass = 2;
  Bench bench({Cube("a", kCubeMass, {0, 0, 1})}, {});
  EXPECT_NEAR(bench.engine().MovablePotential(), kCubeMass * kGravity * 1, 1e-12);
  const double before = bench.engine().KineticEnergy();
  bench.Throw(0, {0.5, 0, 0});
  EXPECT_NEAR(bench.engine().KineticEnergy() - before, kCubeMass * 0.125, 1e-12);
}

TEST(Movables, WithoutTouchingTheyFallThroughTheTable) {
  Bench bench({Cube("a", 1, {0, 0, kSide / 2 + 0.001})}, {Table(0.5)});
  Engine::Options options = bench.engine().options();
  EXPECT_TRUE(options.movables_touch);
  options.movables_touch = false;
  bench.engine().SetOptions(options);
  EXPECT_FALSE(bench.engine().options().movables_touch);
  bench.Run(0.2);
  EXPECT_NEAR(bench.motion(0).X_W.p.z(),
              kSide / 2 + 0.001 - kGravity * kOneStep * kOneStep * 200 * 201 / 2, 1e-9);
  EXPECT_EQ(bench.engine().contact_count(), 0);
}

}  // namespace
}  // namespace predictor
