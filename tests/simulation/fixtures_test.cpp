// Tests fixtures in the world. The carried object must rest and slide on fixtures, and must not
// pass through them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "core/error.h"
#include "event_fixtures.h"
#include "scenario/paths.h"
#include "simulation/controlled_scene.h"
#include "support/allocation_guard.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr double kBoxMass = 9;      // [kg]
constexpr double kTableGap = 0.05;  // between box and table before the box sags [m]
constexpr double kVertical = 500;   // stiffness of the cobot's controller [N/m]

// Returns the middle of the box's lower face at cobot.posture, before the cobot sags.
Vector3 BottomOf(const Scenario& s) {
  const ControlledRobot robot(s);
  return robot.data.FramePose(*robot.model, robot.end_effector).p - Vector3(0, 0, 0.2);
}

FixtureSpec TableUnder(const Scenario& s, double friction) {
  FixtureSpec table;
  table.size = {1, 2, 0.1};
  table.xyz = BottomOf(s) - Vector3(0, 0, kTableGap + 0.05);
  table.friction = friction;
  return table;
}

// Returns a scenario in which the box sags onto a table.
Scenario OnATable(double friction) {
  Scenario s = BoxScene(kBoxMass);
  s.right_handle->pose.rpy.setZero();
  s.environment.fixtures = {TableUnder(s, friction)};
  return s;
}

double Bottom(const World& world) { return world.state().object.X_W.p.z() - 0.1; }

TEST(Fixtures, ABoxRestsOnATable) {
  const Scenario s = OnATable(0.5);
  World world(s);
  const double top = s.environment.fixtures[0].xyz.z() + 0.05;
  EXPECT_NEAR(Bottom(world), top, 1e-4);
  RunWith(&world, HandsOff(s), 1);
  EXPECT_NEAR(Bottom(world), top, 1e-4);
  EXPECT_LT(world.state().object.V_W.norm(), 1e-5);
}

// The table carries the part of the weight that the cobot's spring does not carry.
TEST(Fixtures, ABoxSlidesWhenTheHandsExceedItsFriction) {
  constexpr double kFriction = 0.3;
  const double normal = kBoxMass * kGravity - kVertical * kTableGap;
  for (const double share : {0.9, 1.3}) {
    const Scenario s = OnATable(kFriction);
    World world(s);
    const Vector3 start = world.state().object.X_W.p;
    RunWith(&world, Push(s, {0, share * kFriction * normal / 2, 0}), 1);
    const double moved = world.state().object.X_W.p.y() - start.y();
    EXPECT_EQ(moved > 0.02, share > 1) << moved;
    EXPECT_EQ(moved < 2e-3, share < 1) << moved;
  }
}

// The cobot's spring and the fixture's spring share the hands' force.
TEST(Fixtures, ABoxOnOneThatYieldsMovesByTheForceOverBothStiffnesses) {
  constexpr double kStiffness = 4000, kForce = 20;  // [N/m], of each hand [N]
  Scenario s = OnATable(0);
  // If the box hung on a joint or the cobot were compliant sideways, the box would slip off the
  // ball.
  s.object.attachment.joint = JointType::kFixed;
  s.cobot.controller.Set("stiffness.translation=[300, 300, 500]");
  FixtureSpec& post = s.environment.fixtures[0];
  post.shape = FixtureShape::kSphere;  // touches the box at one point, below its middle
  post.size = {0.05, 0, 0};
  post.stiffness = kStiffness;
  post.damping = 100;
  World world(s);
  const double before = world.state().object.X_W.p.z();
  RunWith(&world, Push(s, {0, 0, -kForce}), 2);
  const double expected = 2 * kForce / (kStiffness + kVertical);
  EXPECT_NEAR(before - world.state().object.X_W.p.z(), expected, 0.02 * expected);
}

TEST(Fixtures, AWallStopsTheBoxThatIsPushedIntoIt) {
  constexpr double kGap = 0.03;  // [m]
  Scenario s = RigidBox();
  s.object.attachment.on_end_effector.rpy.z() = -0.785;  // its faces are along the axes of W
  const World free(s);
  FixtureSpec wall;
  wall.size = {0.1, 2, 2};
  const double face = free.state().object.X_W.p.x() + 0.13 + kGap;
  wall.xyz = {face + 0.05, 0, free.state().object.X_W.p.z()};
  s.environment.fixtures = {wall};
  World world(s);
  RunWith(&world, Push(s, {15, 0, 0}), 1.5);
  EXPECT_NEAR(world.state().object.X_W.p.x() - free.state().object.X_W.p.x(), kGap, 2e-3);
  s.environment.fixtures[0].touches = {"cobot"};
  World through(s);
  RunWith(&through, Push(s, {15, 0, 0}), 0.5);
  EXPECT_GT(through.state().object.X_W.p.x() - free.state().object.X_W.p.x(), 2 * kGap);
}

// The hull of a link of the cobot must not pass through a fixture that may touch the cobot.
TEST(Fixtures, ALinkOfTheCobotIsStopped) {
  Scenario s = RigidBox();
  FixtureSpec wall;
  wall.shape = FixtureShape::kPlane;
  wall.touches = {"cobot"};
  const World free(s);
  wall.xyz = free.state().end_effector.X_W.p + Vector3(0.2, 0, 0);  // the flange is thinner
  wall.rpy = {0, -M_PI / 2, 0};                                     // its normal is −x
  s.environment.fixtures = {wall};
  World world(s);
  double farthest = 0;
  for (int k = 0; k < 1500; ++k) {
    ASSERT_TRUE(world.Step(Push(s, {10, 0, 0}), kTick).ok());
    farthest = std::max(farthest, world.state().end_effector.X_W.p.x());
  }
  const double moved = farthest - free.state().end_effector.X_W.p.x();
  EXPECT_GT(moved, 0.05);
  EXPECT_LT(moved, 0.2);
  EXPECT_LT(world.state().end_effector.V_W.norm(), 0.02);
}

// The box passes through the volume, and a link does not.
TEST(Fixtures, OnlyTheCobotIsKeptOutOfAKeepOutVolume) {
  Scenario s = RigidBox();
  const World free(s);
  FixtureSpec volume;
  volume.shape = FixtureShape::kPlane;
  volume.xyz = free.state().end_effector.X_W.p + Vector3(0.2, 0, 0);
  volume.rpy = {0, -M_PI / 2, 0};  // its normal is −x
  volume.keep_out = true;
  s.environment.fixtures = {volume};
  World world(s);
  double farthest = 0;
  for (int k = 0; k < 1500; ++k) {
    ASSERT_TRUE(world.Step(Push(s, {10, 0, 0}), kTick).ok());
    farthest = std::max(farthest, world.state().end_effector.X_W.p.x());
  }
  EXPECT_LT(farthest, volume.xyz.x());
  // The box is 0.26 m wide, and its middle is below the flange.
  EXPECT_GT(world.state().object.X_W.p.x() + 0.13, volume.xyz.x());
  s.environment.fixtures[0].xyz.x() -= 0.25;
  EXPECT_NE(RefusalOf(s).find("inside this keep-out volume. Move the keep-out volume, or change "
                              "cobot.posture."),
            std::string::npos)
      << RefusalOf(s);
}

// The solver's warm start is part of the state.
TEST(Fixtures, ASavedStateContinuesBitForBitInContact) {
  const Scenario s = OnATable(0.3);
  const WorldInput input = Push(s, {3, 12, -5});
  World world(s), other(s);
  RunWith(&other, HandsOff(s), 0.07);  // leaves traces that the loaded state must replace
  RunWith(&world, input, 0.3);
  CopyState(&world, &other);
  for (int round = 0; round < 2; ++round) {
    RunWith(&world, input, 0.4);
    RunWith(&other, input, 0.4);
    EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
    EXPECT_EQ((world.state().object.X_W.p - other.state().object.X_W.p).norm(), 0);
    EXPECT_EQ((world.state().object.V_W - other.state().object.V_W).norm(), 0);
    world.Reset();
    other.Reset();
  }
}

TEST(Fixtures, AScenarioWithoutThemHasTheSameMotionAsWithOneFarAway) {
  const Scenario s = BoxScene(kBoxMass);
  Scenario far = s;
  far.environment.fixtures = {FixtureSpec{}};
  far.environment.fixtures[0].xyz = {50, 0, 0};
  World world(s), other(far);
  const WorldInput input = Push(s, {3, 12, -5});
  RunWith(&world, input, 0.3);
  RunWith(&other, input, 0.3);
  EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
  EXPECT_EQ((world.state().object.X_W.p - other.state().object.X_W.p).norm(), 0);
}

TEST(Fixtures, OfEveryShapeTakeNothingFromTheHeap) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Scenario s = BoxScene(kBoxMass);
  const Vector3 bottom = BottomOf(s);
  int touching = 0;
  for (const FixtureShape shape :
       {FixtureShape::kBox, FixtureShape::kCylinder, FixtureShape::kCapsule, FixtureShape::kSphere,
        FixtureShape::kPlane}) {
    FixtureSpec fixture;
    fixture.shape = shape;
    fixture.size = {0.04, 0.04, 0.04};
    const double height = shape == FixtureShape::kPlane     ? 0
                          : shape == FixtureShape::kCapsule ? 0.06
                          : shape == FixtureShape::kSphere  ? 0.04
                                                            : 0.02;
    fixture.xyz = bottom + Vector3(0.05 * (touching - 2), 0.08 * (touching % 2), -0.02 - height);
    // A plane would also touch the foot of the cobot, so only the object may touch a plane.
    if (shape != FixtureShape::kPlane) fixture.touches = {"object", "cobot"};
    s.environment.fixtures.push_back(fixture);
    ++touching;
  }
  World world(s);
  const WorldInput push = Push(s, {4, -5, -40});
  bool ok = true;
  const test::AllocationGuard guard;
  for (int k = 0; k < 1000; ++k) ok = world.Step(push, kTick).ok() && ok;
  world.Reset();
  const std::int64_t count = guard.count();
  EXPECT_EQ(count, 0);
  EXPECT_TRUE(ok);
}

// ---- bad input ---------------------------------------------------------------------------------

std::string StartError(const Scenario& s) {
  try {
    const World world(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Fixtures, AStartInsideOneIsRefused) {
  Scenario s = BoxScene(kBoxMass);
  s.environment.fixtures = {TableUnder(s, 0.3), TableUnder(s, 0.3)};
  s.environment.fixtures[1].xyz.z() += kTableGap + 0.012;
  EXPECT_EQ(StartError(s),
            "environment.fixtures.1: at cobot.posture, the object is 12 mm inside this fixture. "
            "Move the fixture, or change cobot.posture.");
  s.environment.fixtures[1].touches = {"cobot"};
  s.environment.fixtures[1].size.head<2>() = Eigen::Vector2d(0.3, 0.3);  // far from its foot
  EXPECT_EQ(StartError(s), "");
  s.environment.fixtures[1].xyz.z() += 0.25;  // through the flange
  EXPECT_NE(StartError(s).find("environment.fixtures.1: at cobot.posture, the cobot's link "
                               "\"panda_link"),
            std::string::npos)
      << StartError(s);
  EXPECT_NE(StartError(s).find("remove cobot from the fixture's touches"), std::string::npos);
}

TEST(Fixtures, AStartInsideTheTableOrTheFloorIsRefused) {
  Scenario s = BoxScene(kBoxMass);
  const Vector3 bottom = BottomOf(s);
  s.environment.table = TableSpec{};
  s.environment.table->top = bottom + Vector3(0, 0, 0.062);
  EXPECT_EQ(StartError(s),
            "environment.table: at cobot.posture, the object is 62 mm inside the table. Lower the "
            "table, or change cobot.posture.");
  s.environment.floor = true;  // far below
  EXPECT_EQ(StartError(s).find("environment.table: "), 0u) << StartError(s);
  s.environment.table->top = bottom + Vector3(0, 0, 0.0005);
  EXPECT_EQ(StartError(s), "");
  s.cobot.base.xyz.z() -= bottom.z() + 0.025;
  s.environment.table->top.z() = -0.5;
  EXPECT_EQ(StartError(s),
            "environment.floor: at cobot.posture, the object is 25 mm inside the floor. Raise "
            "cobot.base, or change cobot.posture.");
}

TEST(Fixtures, OneThatNothingCouldTouchIsRefused) {
  const test::TemporaryFolder folder;
  Scenario s = OnATable(0.3);
  s.file = folder / "test.yaml";
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
  };
  write("bare.urdf",
        R"(<robot name="bare"><link name="bare"><inertial><mass value="2"/>)"
        R"(<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>)"
        R"(<visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link></robot>)");
  s.object.primitive.reset();
  s.object.model = "bare.urdf";
  const std::string file = (folder / "bare.urdf").string();
  EXPECT_EQ(StartError(s),
            "environment.fixtures.0.touches contains object, but " + file +
                " has no <collision>, so nothing would collide. Add <collision> to the links in "
                "this file, or remove this fixture.");
  s.environment.fixtures[0].touches = {"cobot"};
  s.environment.fixtures[0].size.head<2>() = Eigen::Vector2d(0.3, 0.3);  // far from its foot
  EXPECT_EQ(StartError(s), "");

  std::ifstream panda(ResolveModelPath(s.cobot.model, folder));
  const std::string urdf((std::istreambuf_iterator<char>(panda)), {});
  ASSERT_NE(urdf.find("<collision>"), std::string::npos);
  write("panda.urdf",
        std::regex_replace(urdf, std::regex("<collision>[\\s\\S]*?</collision>"), ""));
  s.cobot.model = "panda.urdf";
  s.environment.fixtures[0].touches = {"object", "cobot"};
  s.object.model.clear();
  s.object.primitive = BoxScene(kBoxMass).object.primitive;
  EXPECT_EQ(StartError(s),
            "environment.fixtures.0.touches contains cobot, but " +
                (folder / "panda.urdf").string() +
                " has no <collision> in a link that a joint moves, so nothing would collide. Add "
                "<collision> to the links in this file, or remove cobot from this list.");
}

TEST(Fixtures, OneTooStiffForTheStepOfTheSimulationIsRefused) {
  Scenario s = OnATable(0.3);
  s.environment.fixtures[0].stiffness = 1e7;
  const std::string error = StartError(s);
  EXPECT_EQ(error.find("environment.fixtures.0.stiffness and damping are so large that a body of"),
            0u)
      << error;
  EXPECT_NE(error.find("the stiffness can be at most"), std::string::npos) << error;
}

}  // namespace
}  // namespace predictor
