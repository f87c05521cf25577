// A run must start in static equilibrium.
#include <gtest/gtest.h>

#include "core/error.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

Pose SetPoint(const Scenario& s) {
  const ControlledRobot robot(s);
  return robot.data.FramePose(*robot.model, robot.end_effector);
}

// Only the vertical spring carries the load, so the load sags to m g / K below the set-point.
TEST(Equilibrium, SagsByWeightOverStiffness) {
  for (const double mass : {9.0, 18.0}) {
    const Scenario s = BoxScene(mass);
    const World world(s);
    const Vector3 sag = SetPoint(s).p - world.state().end_effector.X_W.p;
    EXPECT_NEAR(sag.z(), mass * kGravity / 500, 1e-7);
    EXPECT_LT(sag.head<2>().norm(), 1e-6);
    EXPECT_NEAR(world.object_mass(), mass, 1e-12);
  }
}

TEST(Equilibrium, StandsStill) {
  for (const double mass : {9.0, 18.0}) {
    const Scenario s = BoxScene(mass);
    World world(s);
    const FrameMotion start = world.state().object;
    EXPECT_TRUE(start.V_W.isZero(0));
    Simulate(&world, HandsOff(s), 2.0);
    EXPECT_LT(PoseError(world.state().object.X_W, start.X_W).norm(), 1e-8);
    EXPECT_LT(world.state().object.V_W.norm(), 1e-8);
  }
}

// A box held away from its centre of mass tilts until this centre lies below the joint.
TEST(Equilibrium, HangsWithItsCentreOfMassBelowTheJoint) {
  Scenario s = BoxScene(9);
  s.object.primitive->center_of_mass = {0.03, -0.05, -0.02};
  const World world(s);
  const Pose X_WO = world.state().object.X_W;
  const Vector3 joint = X_WO * s.object.attachment.on_object.xyz;
  const Vector3 com = X_WO * s.object.primitive->center_of_mass;
  EXPECT_LT((com - joint).head<2>().norm(), 1e-8);
  EXPECT_LT(com.z(), joint.z());
  EXPECT_LT((joint - world.state().end_effector.X_W.p).norm(), 1e-9);
}

// A box balanced above the joint would topple, so the program must not accept this equilibrium as a
// start.
TEST(Equilibrium, DoesNotBalance) {
  Scenario s = BoxScene(9);
  s.object.attachment.on_object.xyz = {0, 0, -0.1};
  World world(s);
  EXPECT_LT(world.state().object.X_W.p.z(), world.state().end_effector.X_W.p.z() - 0.09);
  Simulate(&world, HandsOff(s), 1.0);
  EXPECT_LT(world.state().object.V_W.norm(), 1e-7);
}

TEST(Equilibrium, RestsOnTheTableUnderneath) {
  Scenario s = BoxScene(9);
  s.environment.table = TableSpec{};
  // Before the cobot sags, the lower face of the box is 0.05 m above the table.
  const double top = SetPoint(s).p.z() - 0.2 - 0.05;
  s.environment.table->top = {0.5, 0, top};
  World world(s);
  const double bottom = world.state().object.X_W.p.z() - 0.1;
  EXPECT_NEAR(bottom, top, 1e-3);
  Simulate(&world, HandsOff(s), 1.0);
  EXPECT_NEAR(world.state().object.X_W.p.z() - 0.1, bottom, 1e-6);
}

TEST(Equilibrium, HandGuidingRestsOnTheTable) {
  Scenario s = BoxScene(9);
  s.cobot.controller = {"gravity_compensation", {}};
  s.environment.table = TableSpec{};
  s.environment.table->top = {0.5, 0, SetPoint(s).p.z() - 0.2 - 0.001};
  World world(s);
  EXPECT_NEAR(world.state().object.X_W.p.z() - 0.1, s.environment.table->top.z(), 1e-3);
}

std::string Refusal(const Scenario& s) {
  try {
    const World world(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Equilibrium, RefusesWhatTheCobotCannotHold) {
  Scenario s = BoxScene(18);
  s.cobot.effort_limit = {};  // the wrist's 12 N·m cannot hold 18 kg at 0.088 m
  EXPECT_NE(Refusal(s).find("effort limit of "), std::string::npos) << Refusal(s);
  s = BoxScene(9);
  s.cobot.controller = {"gravity_compensation", {}};
  EXPECT_NE(Refusal(s), "");
  s = BoxScene(9);
  s.cobot.controller.Set("stiffness.translation=[100, 100, 50]");
  EXPECT_NE(Refusal(s), "");
}

TEST(Equilibrium, TakesTheEffortLimitsOfTheScenario) {
  Scenario s = BoxScene(9);
  s.cobot.effort_limit = {87, 87, 87, 87, 12, 5, 12};
  EXPECT_NE(Refusal(s).find("effort limit of "), std::string::npos) << Refusal(s);
  s.cobot.effort_limit = {1, 2, 3};
  EXPECT_NE(Refusal(s).find("cobot.effort_limit"), std::string::npos) << Refusal(s);
}

TEST(Equilibrium, RefusesAPostureThatDoesNotFit) {
  Scenario s = BoxScene(9);
  s.cobot.posture.pop_back();
  EXPECT_THROW(World{s}, InputError);
  s = BoxScene(9);
  s.cobot.posture[3] = 0.5;
  EXPECT_THROW(World{s}, InputError);
}

TEST(Equilibrium, RefusesAHandleOffTheObject) {
  Scenario s = BoxScene(9);
  s.left_handle->pose.xyz = {0, 2, 0};
  EXPECT_THROW(World{s}, InputError);
}

}  // namespace
}  // namespace predictor
