// Compares the virtual cobot's own safety functions with closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.h"
#include "simulation/controlled_scene.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

// Returns a cobot with a box fixed to the flange, whose handle is at the flange.
Scenario SafeCobot(double mass = 2) {
  Scenario s = BoxScene(mass);
  s.object.attachment.joint = JointType::kFixed;
  s.object.attachment.on_object.xyz = {0, 0, 0};
  s.left_handle->pose = {};
  s.right_handle.reset();
  return s;
}

// Runs until the cobot stops itself. Returns the time of the stop, or −1 if the cobot does not stop
// itself.
double TimeOfStop(World* world, const WorldInput& input, double longest) {
  for (int k = 0; k < std::lround(longest / kTick); ++k) {
    EXPECT_TRUE(world->Step(input, kTick).ok());
    if (world->state().cobot_stop != 0) return world->state().time;
  }
  return -1;
}

// Returns the time of the stop under a force that grows slowly to `force` [N] within 2 s, so that
// nothing swings.
double TimeOfStopUnderRamp(const Scenario& s, const Vector3& force, CobotStop* stop) {
  World world(s);
  for (int k = 0; k < 3000; ++k) {
    EXPECT_TRUE(world.Step(Push(s, std::min(1.0, k / 2000.0) * force), kTick).ok());
    *stop = static_cast<CobotStop>(world.state().cobot_stop);
    if (*stop != CobotStop::kNone) return world.state().time;
  }
  return -1;
}

CobotStop StopOf(const World& world) { return static_cast<CobotStop>(world.state().cobot_stop); }

// For any payload, the estimate must settle at the force that acts.
TEST(CobotSafety, EstimatesTheForceOnTheEndEffector) {
  Scenario s = SafeCobot();
  s.cobot.safety.force = 12;
  CobotStop stop;
  EXPECT_EQ(TimeOfStopUnderRamp(s, {0, 0, -11.8}, &stop), -1);
  EXPECT_GT(TimeOfStopUnderRamp(s, {0, 0, -12.2}, &stop), 1.9);
  EXPECT_EQ(stop, CobotStop::kForce);
}

// With a first-order observer of rate f, a step of force F crosses the limit after
// −ln(1 − limit / F) / (2π f).
TEST(CobotSafety, ObserverIsOfFirstOrder) {
  Scenario s = SafeCobot(0.001);
  s.cobot.safety.force = 10;
  s.cobot.safety.observer_rate = 5;
  World world(s);
  const double expected = -std::log(1 - 10.0 / 20) / (2 * M_PI * 5);
  EXPECT_NEAR(TimeOfStop(&world, Push(s, {0, 0, -20}), 1), expected, 0.004);
}

TEST(CobotSafety, StopsAtASpeedAndThenHolds) {
  Scenario s = SafeCobot();
  s.cobot.safety.speed = 0.1;
  World world(s);
  const WorldInput push = Push(s, {10, 0, 0});
  ASSERT_GT(TimeOfStop(&world, push, 3), 0);
  EXPECT_EQ(StopOf(world), CobotStop::kSpeed);
  EXPECT_NEAR(world.state().end_effector.V_W.head<3>().norm(), 0.1, 2e-3);
  const Vector3 decided = world.state().end_effector.X_W.p;
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
  EXPECT_LT(world.state().v.lpNorm<Eigen::Infinity>(), 1e-3);
  // The fastest joint decelerates from the speed v with the deceleration a. In each joint, the path
  // is at most v² / 2a.
  const Vector3 rest = world.state().end_effector.X_W.p;
  EXPECT_LT((rest - decided).norm(), 0.02);
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(world.Step(push, kTick).ok());
  EXPECT_EQ(StopOf(world), CobotStop::kSpeed);  // the cobot does not restart on its own
  world.Reset();
  EXPECT_EQ(StopOf(world), CobotStop::kNone);
}

TEST(CobotSafety, JointDeceleratesAsConfigured) {
  Scenario s = SafeCobot();
  s.cobot.safety.speed = 0.2;
  s.cobot.safety.stop_deceleration = 2;
  World world(s);
  ASSERT_GT(TimeOfStop(&world, Push(s, {0, 15, 0}), 3), 0);
  Eigen::Index fastest = 0;
  const double v = world.state().v.cwiseAbs().maxCoeff(&fastest);
  const double q = world.state().q[fastest];
  for (int k = 0; k < 3000; ++k) ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
  EXPECT_NEAR(std::abs(world.state().q[fastest] - q), v * v / (2 * 2), 0.05 * v * v);
}

// Returns the arm's effective mass at the flange along n, 1 / (nᵀ J M⁻¹ Jᵀ n) [kg].
double MassAlong(const Scenario& s, const WorldState& state, const Vector3& n) {
  ControlledRobot robot(s);
  robot.Update(state.q, state.v);
  Jacobian J;
  robot.data.FrameJacobian(*robot.model, robot.end_effector, &J);
  const Eigen::MatrixXd Jv = J.topRows<3>(), M = robot.data.M();
  return 1 / (n.transpose() * Jv * M.inverse() * Jv.transpose() * n)(0, 0);
}

TEST(CobotSafety, StopsAtAMomentum) {
  Scenario s = SafeCobot();
  s.cobot.safety.momentum = 0.5;
  World world(s);
  ASSERT_GT(TimeOfStop(&world, Push(s, {10, 0, 0}), 3), 0);
  EXPECT_EQ(StopOf(world), CobotStop::kMomentum);
  const Vector3 v = world.state().end_effector.V_W.head<3>();
  EXPECT_NEAR(MassAlong(s, world.state(), v.normalized()) * v.norm(), 0.5, 0.02);
}

TEST(CobotSafety, StopsAtAnExternalTorqueInAJoint) {
  Scenario s = SafeCobot();
  s.cobot.safety.joint_torque = 6;
  World world(s);
  ControlledRobot robot(s);
  robot.Update(world.state().q, JointVector::Zero(7));
  Jacobian J;
  robot.data.FrameJacobian(*robot.model, robot.end_effector, &J);
  const double lever = J.row(2).cwiseAbs().maxCoeff();  // of a vertical force [m]
  CobotStop stop;
  EXPECT_EQ(TimeOfStopUnderRamp(s, {0, 0, -0.95 * 6 / lever}, &stop), -1);
  EXPECT_GT(TimeOfStopUnderRamp(s, {0, 0, -1.05 * 6 / lever}, &stop), 1.8);
  EXPECT_EQ(stop, CobotStop::kJointTorque);
}

// Above the cap, the force of the spring of 500 N/m no longer grows, so a hand can push the cobot
// away.
TEST(CobotSafety, ForceCapBoundsTheSpring) {
  Scenario s = SafeCobot();
  s.cobot.safety.force_cap = 10;
  World world(s);
  const double start = world.state().end_effector.X_W.p.z();
  for (int k = 0; k < 3000; ++k) ASSERT_TRUE(world.Step(Push(s, {0, 0, -8}), kTick).ok());
  EXPECT_NEAR(start - world.state().end_effector.X_W.p.z(), 8.0 / 500, 5e-4);
  world.Reset();
  for (int k = 0; k < 3000; ++k) ASSERT_TRUE(world.Step(Push(s, {0, 0, -13}), kTick).ok());
  EXPECT_GT(start - world.state().end_effector.X_W.p.z(), 2 * 13.0 / 500);
}

// Above the speed cap, the cobot brakes with the time constant T = 10 ms, and m is the arm's
// effective mass. The speed settles at F T / m above the cap.
TEST(CobotSafety, SpeedCapBrakes) {
  Scenario s = SafeCobot();
  s.cobot.controller = {"gravity_compensation", {}};
  s.environment.gravity = 0;
  World free(s);
  s.cobot.safety.speed_cap = 0.05;
  World capped(s);
  double fastest = 0, unbounded = 0;
  for (int k = 0; k < 600; ++k) {
    ASSERT_TRUE(capped.Step(Push(s, {8, 0, 0}), kTick).ok());
    ASSERT_TRUE(free.Step(Push(s, {8, 0, 0}), kTick).ok());
    fastest = std::max(fastest, capped.state().end_effector.V_W.head<3>().norm());
    unbounded = std::max(unbounded, free.state().end_effector.V_W.head<3>().norm());
  }
  EXPECT_GT(unbounded, 0.15);
  const double mass = MassAlong(s, capped.state(), Vector3::UnitX());
  EXPECT_NEAR(fastest, 0.05 + 8 * 0.01 / mass, 0.15 * 8 * 0.01 / mass);
}

TEST(CobotSafety, IsOffByDefault) {
  Scenario s = SafeCobot();
  World world(s);
  EXPECT_EQ(TimeOfStop(&world, Push(s, {0, 0, -40}), 1), -1);
}

}  // namespace
}  // namespace predictor
