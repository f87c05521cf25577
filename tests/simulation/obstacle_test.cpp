// Tests a fixture that is absent until an event.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "event_fixtures.h"

namespace predictor {
namespace {

constexpr double kWallGap = 0.03;  // between the box and the wall at the start [m]

// Returns a scenario in which a wall in front of the box appears at the time `after` [s] for
// `duration` [s].
Scenario WithWall(double after, double duration = 0) {
  Scenario s = RigidBox();
  s.object.attachment.on_end_effector.rpy.z() = -0.785;  // its faces are along the axes of W
  const Vector3 start = World(s).state().object.X_W.p;
  FixtureSpec wall;
  wall.size = {0.1, 2, 2};
  wall.xyz = start + Vector3(0.13 + kWallGap + 0.05, 0, 0);
  wall.name = "wall";
  s.environment.fixtures = {FixtureSpec{}, wall};
  s.environment.fixtures[0].xyz = {50, 0, 0};
  s.events = {Event("obstacle_appears", after, {"fixture=wall"})};
  s.events[0].duration = duration;
  return s;
}

// Returns how far the box has moved from its start [m] after a push of 15 N for `time` [s].
double MovedBy(const Scenario& s, double time) {
  World world(s);
  const double start = world.state().object.X_W.p.x();
  RunWith(&world, Push(s, {15, 0, 0}), time);
  return world.state().object.X_W.p.x() - start;
}

TEST(Obstacle, StopsTheObjectOnceItIsThere) {
  EXPECT_NEAR(MovedBy(WithWall(0), 1.5), kWallGap, 2e-3);
  Scenario never = WithWall(100);
  const double free = MovedBy(never, 0.5);
  EXPECT_GT(free, 2 * kWallGap);
  never.environment.fixtures.clear();
  never.events.clear();
  EXPECT_EQ(MovedBy(never, 0.5), free);
}

TEST(Obstacle, IsGoneWhenItsEventEnds) {
  EXPECT_NEAR(MovedBy(WithWall(0, 2), 1.5), kWallGap, 2e-3);
  EXPECT_GT(MovedBy(WithWall(0, 1), 1.5), 2 * kWallGap);
}

// The event begins while the box is at the place of the wall. Even then, no sudden force may act.
TEST(Obstacle, WaitsUntilItsPlaceIsFree) {
  constexpr double kBegin = 0.5;  // [s]
  const Scenario s = WithWall(kBegin);
  Scenario without = s;
  without.events[0].trigger.after = 100;
  World world(s), other(without);
  const WorldInput push = Push(s, {15, 0, 0});
  const double start = world.state().object.X_W.p.x();
  RunWith(&world, push, kBegin + 0.1);
  RunWith(&other, push, kBegin + 0.1);
  EXPECT_GT(world.state().object.X_W.p.x() - start, kWallGap + 0.02);
  EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
  EXPECT_EQ(world.state().events, 1u);
  // The hands pull the box back. The wall then appears, and the box must not pass it again.
  RunWith(&world, Push(s, {-15, 0, 0}), 1.3);
  ASSERT_LT(world.state().object.X_W.p.x() - start, kWallGap - 0.02);
  RunWith(&world, push, 2);
  EXPECT_NEAR(world.state().object.X_W.p.x() - start, kWallGap, 2e-3);
}

// Wall and gate appear at the same time. The box is where the wall would be and meets the gate.
TEST(Obstacle, OnlyTheOneWhosePlaceIsTakenWaits) {
  constexpr double kBegin = 0.5;  // [s]
  Scenario s = WithWall(kBegin);
  const Vector3 start = World(s).state().object.X_W.p;
  FixtureSpec gate;
  gate.size = {2, 0.1, 2};
  gate.xyz = start + Vector3(0, 0.19 + kWallGap + 0.05, 0);
  gate.name = "gate";
  const auto moved = [&start](const Scenario& scenario) -> Vector3 {
    World world(scenario);
    RunWith(&world, Push(scenario, {15, 0, 0}), kBegin + 0.1);
    RunWith(&world, Push(scenario, {15, 15, 0}), 1);
    return world.state().object.X_W.p - start;
  };
  const Vector3 without = moved(s);
  s.environment.fixtures.push_back(gate);
  s.events.push_back(Event("obstacle_appears", kBegin, {"fixture=gate"}));
  const Vector3 with = moved(s);
  EXPECT_GT(without.y(), 2 * kWallGap);
  EXPECT_LT(with.y(), kWallGap + 0.01);
  EXPECT_GT(with.x(), kWallGap + 0.02);  // the wall is not there
}

TEST(Obstacle, ASavedStateContinuesBitForBit) {
  const Scenario s = WithWall(0.2);
  const WorldInput push = Push(s, {15, 2, 0});
  World world(s), other(s);
  RunWith(&world, push, 0.3);  // the wall is there
  CopyState(&world, &other);
  for (int round = 0; round < 2; ++round) {
    RunWith(&world, push, 0.6);
    RunWith(&other, push, 0.6);
    EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
    EXPECT_EQ((world.state().object.V_W - other.state().object.V_W).norm(), 0);
    world.Reset();
    other.Reset();
  }
  CopyState(&world, &other);  // before the wall is there
  RunWith(&other, push, 0.6);
  RunWith(&world, push, 0.6);
  EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
}

TEST(Obstacle, TakesNothingFromTheHeap) { ExpectNoHeap(WithWall(0.1, 0.5), {15, 0, 0}, 1000); }

std::string StartErrorOf(const Scenario& s) {
  try {
    const World world(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Obstacle, ThatDoesNotExistIsAnError) {
  Scenario s = WithWall(0);
  s.events[0].Set("fixture=gate");
  EXPECT_EQ(StartErrorOf(s),
            "events.0.fixture: no fixture has the name \"gate\". " + Suggestion("gate", {"wall"}));
  s.environment.fixtures.clear();
  EXPECT_EQ(StartErrorOf(s),
            "events.0.fixture: no fixture has the name \"gate\". In environment.fixtures, give a "
            "name to the fixture that appears.");
}

TEST(Obstacle, MayBeginInsideTheObject) {
  Scenario s = WithWall(0);
  s.environment.fixtures[1].xyz.x() -= 0.2;
  EXPECT_EQ(StartErrorOf(s), "");
}

}  // namespace
}  // namespace predictor
