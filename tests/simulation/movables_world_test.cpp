// Tests movable objects in the world of a cobot. The carried object must push the movable objects.
// The carried object's start and the linear model must not depend on the movable objects.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "event_fixtures.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr double kBrickMass = 4;        // [kg]
constexpr double kBrickFriction = 0.4;  // of the table
constexpr double kBrickGap = 0.02;      // between the carried box and the brick at the start [m]

// Returns a scenario in which the cobot carries a box above a table. A brick stands on the table,
// beside the box in the direction x.
Scenario WithABrick(double gap = kBrickGap) {
  Scenario s = RigidBox();
  s.right_handle->pose.rpy.setZero();
  s.cobot.payload = PayloadSpec{2, {0, 0, 0.1}};
  s.object.attachment.on_end_effector.rpy.z() = -0.785;  // its faces are along the axes of W
  const Vector3 box = World(s).state().object.X_W.p;
  MovableSpec brick;
  brick.name = "brick";
  brick.primitive = PrimitiveSpec{};
  brick.primitive->size = {0.3, 0.3, 0.2};  // it slides before it would tip
  brick.primitive->mass = kBrickMass;
  brick.xyz = box + Vector3(0.13 + gap + 0.15, 0, -0.05);
  FixtureSpec table;
  table.size = {2, 2, 0.1};
  table.xyz = box - Vector3(0, 0, 0.15 + 0.05);
  table.friction = kBrickFriction;
  s.environment.friction = 0;  // between box and brick: the box must not press it down or lift it
  s.environment.objects = {brick};
  s.environment.fixtures = {table};
  return s;
}

const MovableMotion& Brick(const World& world) { return world.state().movables.motion[0]; }

Scenario WithoutObjects(Scenario s) {
  s.environment.objects.clear();
  return s;
}

// The hands push the box against the brick, and the cobot that holds the box hardly resists,
// because it is soft sideways (5 N/m).
TEST(MovableObject, SlidesWhenTheHandsExceedItsFriction) {
  const double limit = kBrickFriction * kBrickMass * kGravity;
  for (const double share : {0.9, 1.3}) {
    const Scenario s = WithABrick(0.0005);  // so the box is still slow when it meets the brick
    World world(s);
    ASSERT_EQ(world.state().movables.count, 1);
    const double start = Brick(world).X_W.p.x();
    RunWith(&world, Push(s, {share * limit / 2, 0, 0}), 1.2);
    const double moved = Brick(world).X_W.p.x() - start;
    EXPECT_EQ(moved > 0.05, share > 1) << moved;
    // In MuJoCo, bodies creep even while the force is below the limit of friction.
    EXPECT_EQ(moved < 0.02, share < 1) << moved;
    // The box is behind the brick and touches it.
    const double behind = Brick(world).X_W.p.x() - world.state().object.X_W.p.x();
    EXPECT_GT(behind, 0.28 - 1e-3);
    EXPECT_LT(behind, 0.29);
  }
}

// The equilibrium and the linear model must be the same as for the cobot and its object alone.
TEST(MovableObject, DoesNotChangeTheStart) {
  const Scenario s = WithABrick(0.002);
  World with(s), without(WithoutObjects(s));
  EXPECT_LT((with.state().q - without.state().q).norm(), 1e-9);
  const LinearModel model = with.Linearise(), expected = without.Linearise();
  ASSERT_EQ(model.A.rows(), expected.A.rows());
  EXPECT_LT((model.A - expected.A).norm(), 1e-6 * expected.A.norm());
  EXPECT_LT((model.B - expected.B).norm(), 1e-6 * expected.B.norm());
  const Vector3 start = Brick(with).X_W.p;
  RunWith(&with, HandsOff(s), 0.5);
  RunWith(&without, HandsOff(s), 0.5);
  EXPECT_LT((with.state().object.X_W.p - without.state().object.X_W.p).norm(), 1e-9);
  EXPECT_LT((Brick(with).X_W.p - start).norm(), 1e-4);
}

// The table carries the brick, and nothing of the box that hangs beside it.
TEST(MovableObject, IsNotCountedAsSupportOfTheBox) {
  Scenario s = WithABrick();
  s.environment.objects[0].xyz.z() -= 1e-5;  // so that it touches the table whatever the rounding
  const ObjectSupport support = World(s).SupportAtStart();
  EXPECT_EQ(support.floor, 0);
  EXPECT_EQ(support.other, 0);
}

TEST(MovableObject, ReturnsToItsStartOnAReset) {
  const Scenario s = WithABrick();
  World world(s);
  const Pose start = Brick(world).X_W;
  RunWith(&world, Push(s, {15, 0, 0}), 0.8);
  EXPECT_GT((Brick(world).X_W.p - start.p).norm(), 0.01);
  world.Reset();
  EXPECT_EQ((Brick(world).X_W.p - start.p).norm(), 0);
  EXPECT_LT(Brick(world).V_W.norm(), 1e-12);
}

TEST(MovableObject, ASavedStateContinuesBitForBit) {
  Scenario s = WithABrick();
  for (const bool released : {false, true}) {
    if (released) s.events = {Event("release_object", 0.3)};
    const WorldInput input = Push(s, {14, 2, 0});
    World world(s), other(s);
    RunWith(&other, HandsOff(s), 0.07);  // leaves traces that the loaded state must replace
    RunWith(&world, input, 0.5);
    CopyState(&world, &other);
    RunWith(&world, input, 0.3);
    RunWith(&other, input, 0.3);
    EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
    EXPECT_EQ((Brick(world).X_W.p - Brick(other).X_W.p).norm(), 0);
    EXPECT_EQ((Brick(world).V_W - Brick(other).V_W).norm(), 0);
    EXPECT_EQ(world.state().energy, other.state().energy);
  }
}

TEST(MovableObject, TheTickDoesNotUseTheHeap) {
  Scenario s = WithABrick();
  ExpectNoHeap(s, {14, 2, 0}, 600);
  s.events = {Event("object_slips", 0.1, {"slip_force=60", "slip_torque=20"})};
  ExpectNoHeap(s, {14, 2, 0}, 600);
}

// An object that a gripper holds with limited force must push a brick in the same way as an object
// on a joint. The brick's inertia also loads the grip.
TEST(MovableObject, AGripPushesItAsAJointDoes) {
  Scenario s = WithABrick(0.002);
  s.environment.fixtures[0].friction = 0;  // sliding bodies hop, and each hop differs
  const WorldInput input = Push(s, {2, 0, 0});
  World joint(s);
  RunWith(&joint, input, 1);
  s.events = {Event("object_slips", 0.01, {"slip_force=500", "slip_torque=200"})};
  World grip(s);
  RunWith(&grip, input, 1);
  const double moved = Brick(joint).X_W.p.x() - s.environment.objects[0].xyz.x();
  EXPECT_GT(moved, 0.05);
  EXPECT_EQ(grip.state().attachment, AttachmentState::kHolds);
  EXPECT_LT((Brick(grip).X_W.p - Brick(joint).X_W.p).norm(), 0.01 * moved);
  EXPECT_LT((grip.state().object.X_W.p - joint.state().object.X_W.p).norm(), 0.01 * moved);
}

// The cobot lets go of the box above the brick.
TEST(MovableObject, CarriesTheReleasedObject) {
  Scenario s = WithABrick();
  MovableSpec& brick = s.environment.objects[0];
  brick.primitive->size = {0.5, 0.5, 0.02};
  brick.xyz = s.environment.fixtures[0].xyz + Vector3(0, 0, 0.05 + 0.01);
  s.events = {Event("release_object", 0.05)};
  World world(s);
  RunWith(&world, HandsOff(s), 1);
  EXPECT_NEAR(world.state().object.X_W.p.z() - Brick(world).X_W.p.z(), 0.1 + 0.01, 1e-4);
  EXPECT_NEAR(Brick(world).X_W.p.z(), brick.xyz.z(), 1e-4);
  EXPECT_LT(world.state().object.V_W.norm(), 1e-4);
}

// A link of the cobot must touch a brick only if the brick's `touches` contains the cobot.
TEST(MovableObject, TouchesTheCobotIfItShould) {
  Scenario s = WithABrick();
  MovableSpec& brick = s.environment.objects[0];
  FixtureSpec& shelf = s.environment.fixtures[0];
  // The shelf is beside the wrist and above the upper face of the box, which is 0.1 m above the
  // box's middle.
  shelf.size = {0.3, 0.3, 0.05};
  shelf.xyz = Vector3(brick.xyz.x(), brick.xyz.y(), brick.xyz.z() + 0.225);
  brick.primitive->size = {0.3, 0.3, 0.5};
  brick.xyz.z() += 0.25 + 0.25;
  for (const bool touches : {false, true}) {
    brick.touches = {touches ? "cobot" : "object"};
    World world(s);
    const double start = Brick(world).X_W.p.x();
    RunWith(&world, Push(s, {20, 0, 0}), 0.8);
    EXPECT_EQ(Brick(world).X_W.p.x() - start > 0.01, touches) << Brick(world).X_W.p.x() - start;
  }
}

std::string ErrorOfStart(const Scenario& s) {
  try {
    World world(s);
  } catch (const InputError& error) {
    EXPECT_TRUE(error.key().ends_with(".xyz")) << error.key();
    return error.what();
  }
  return "";
}

TEST(MovableObject, ThatStartsInsideAnotherBodyIsAnError) {
  Scenario s = WithABrick();
  s.environment.objects[0].xyz.z() -= 0.002;
  EXPECT_EQ(ErrorOfStart(s),
            "environment.objects.0.xyz: at the start, this object is 2 mm inside "
            "environment.fixtures.0. Move it away by at least this distance.");
  s = WithABrick();
  s.environment.fixtures.clear();
  s.environment.floor = true;
  s.environment.objects[0].xyz.z() = 0.1 - 0.0015;
  EXPECT_NE(ErrorOfStart(s).find("is 1.5 mm inside the floor."), std::string::npos);
  s.environment.table = TableSpec{};
  s.environment.table->top = s.environment.objects[0].xyz - Vector3(0, 0, 0.1 - 0.0025);
  s.environment.objects[0].xyz.z() += 0.2, s.environment.table->top.z() += 0.2;
  EXPECT_NE(ErrorOfStart(s).find("is 2.5 mm inside environment.table."), std::string::npos);
  s = WithABrick();
  s.environment.objects.push_back(s.environment.objects[0]);
  s.environment.objects[0].xyz.y() += 0.297;
  EXPECT_EQ(ErrorOfStart(s),
            "environment.objects.1.xyz: at the start, this object is 3 mm inside "
            "environment.objects.0. Move it away by at least this distance.");
}

TEST(MovableObject, ThatTouchesTheCarriedObjectAtTheStartIsAnError) {
  EXPECT_EQ(ErrorOfStart(WithABrick(0.0005)), "");
  const std::string error = ErrorOfStart(WithABrick(-0.0005));
  EXPECT_NE(error.find("after the cobot sagged under its load, this movable object touches the "
                       "carried object (overlap 0.5 mm). Leave a gap between them"),
            std::string::npos)
      << error;
}

TEST(MovableObject, WithoutCollisionShapesIsAnErrorThatNamesItsFile) {
  const test::TemporaryFolder folder;
  Scenario s = WithABrick();
  s.file = folder / "test.yaml";
  std::ofstream(folder / "bare.urdf")
      << R"(<robot name="bare"><link name="bare"><inertial><mass value="2"/>)"
      << R"(<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>)"
      << R"(</link></robot>)";
  s.environment.objects[0].primitive.reset();
  s.environment.objects[0].model = "bare.urdf";
  EXPECT_EQ(RefusalOf(s), "environment.objects.0.model | environment.objects.0.model: " +
                              (folder / "bare.urdf").string() +
                              " has no <collision>, so this movable object would fall through "
                              "everything. Add <collision> to the links in this file.");
  std::swap(s.environment.objects[0].model, s.object.model);
  s.environment.objects[0].primitive = std::exchange(s.object.primitive, {});
  EXPECT_EQ(RefusalOf(s).find("environment.objects.0.touches | environment.objects.0.touches "
                              "contains object, but "),
            0u)
      << RefusalOf(s);
}

TEST(MovableObject, WithAnImpossibleModelIsAnErrorThatNamesIt) {
  Scenario s = WithABrick();
  s.environment.objects[0].primitive->mass = 0;
  try {
    World world(s);
    FAIL() << "a body without mass";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "environment.objects.0.primitive.mass");
  }
}

}  // namespace
}  // namespace predictor
