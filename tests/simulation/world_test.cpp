#include "simulation/world.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "core/motion.h"
#include "core/text.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// In this scenario, only the hands add or remove energy.
Scenario Frictionless(double mass, double ratio) {
  Scenario s = BoxScene(mass);
  s.cobot.joint_friction.viscous = {0};
  s.cobot.effort_limit = {1000};
  s.cobot.controller.Set("stiffness.translation=[100, 100, 500]");
  s.cobot.controller.Set("damping_ratio=" + FormatNumber(ratio));
  s.cobot.controller.Set("posture_stiffness=0");
  return s;
}

bool Same(const WorldState& a, const WorldState& b) {
  return a.time == b.time && a.q == b.q && a.v == b.v && a.torque == b.torque &&
         a.object.X_W.p == b.object.X_W.p && a.object.X_W.q.coeffs() == b.object.X_W.q.coeffs() &&
         a.object.V_W == b.object.V_W && a.object.A_W == b.object.A_W &&
         a.handle[0].V_W == b.handle[0].V_W && a.handle[1].A_W == b.handle[1].A_W &&
         a.energy == b.energy && a.coupling[0] == b.coupling[0];
}

// The test computes the inertia of the cobot and the box from the robot's mass matrix. The
// coordinates are the joint rates and the box's angular velocity (axes of W), so v_com = J_v q̇ + ω
// × r.
TEST(World, ForceOfAHandAcceleratesTheComposedInertia) {
  Scenario s = BoxScene(9);
  s.cobot.joint_friction.viscous = {0};
  World world(s);
  const WorldState start = world.state();
  ControlledRobot robot(s);
  robot.Update(start.q, JointVector::Zero(7));
  Jacobian J;
  robot.data.FrameJacobian(*robot.model, robot.end_effector, &J);
  const MatrixXd Jv = J.topRows(3);
  const Vector3 r = start.object.X_W.p - start.end_effector.X_W.p;
  const Matrix3 R = start.object.X_W.R();
  const Vector3 size = s.object.primitive->size.cwiseAbs2();
  const Vector3 moments =
      9.0 / 12 * Vector3(size[1] + size[2], size[0] + size[2], size[0] + size[1]);
  MatrixXd to_com(3, 10);
  to_com << Jv, -Skew(r);
  MatrixXd M = 9 * to_com.transpose() * to_com;
  M.topLeftCorner(7, 7) += MatrixXd(robot.data.M());
  M.bottomRightCorner(3, 3) += R * moments.asDiagonal() * R.transpose();
  for (std::size_t h = 0; h < kHands; ++h) {
    for (int i = 0; i < 6; ++i) {
      MatrixXd to_handle(6, 10);
      to_handle << Jv, -Skew(start.handle[h].X_W.p - start.end_effector.X_W.p),
          MatrixXd::Zero(3, 7), MatrixXd::Identity(3, 3);
      const VectorXd acceleration =
          to_handle * M.ldlt().solve(to_handle.transpose() * VectorXd::Unit(6, i));
      World pushed(s);
      WorldInput input = HandsOff(s);
      input.F_H_W[h][i] = 1;
      ASSERT_TRUE(pushed.Step(input, kTick).ok());
      // The controller has no effect yet, because E was at rest at the start of the tick.
      EXPECT_LT((pushed.state().handle[h].A_W - acceleration).norm(), 2e-3 * acceleration.norm());
    }
  }
}

TEST(World, AccelerationIsTheChangeOfTwistAndTwistThatOfPose) {
  const Scenario s = BoxScene(9);
  World world(s);
  Simulate(&world, Push(s, {8, -5, 12}), 0.3);
  for (int i = 0; i < 20; ++i) {
    const WorldState a = world.state();
    Simulate(&world, Push(s, {8, -5, 12}), kTick);
    const WorldState b = world.state();
    Simulate(&world, Push(s, {8, -5, 12}), kTick);
    const WorldState c = world.state();
    for (std::size_t h = 0; h < kHands; ++h) {
      const Vector6 V = PoseError(c.handle[h].X_W, a.handle[h].X_W) / (2 * kTick);
      EXPECT_LT((V - 0.5 * (b.handle[h].V_W + c.handle[h].V_W)).norm(), 1e-3 * V.norm());
      const Vector6 A = (c.handle[h].V_W - b.handle[h].V_W) / kTick;
      EXPECT_LT((A - c.handle[h].A_W).norm(), 1e-2 * (1 + A.norm()));
    }
    const Vector6 A_E = (c.end_effector.V_W - b.end_effector.V_W) / kTick;
    EXPECT_LT((A_E - c.end_effector.A_W).norm(), 1e-9);
    EXPECT_GT(c.handle[0].V_W.norm(), 0.05);
  }
}

TEST(World, HandlesAreRigidWithTheObject) {
  const Scenario s = BoxScene(9);
  World world(s);
  Simulate(&world, Push(s, {8, -5, 12}), 0.5);
  const WorldState& state = world.state();
  const FrameMotion D = MotionOfFixed(state.object, s.right_handle->pose.ToPose());
  EXPECT_LT(PoseError(D.X_W, state.handle[1].X_W).norm(), 1e-12);
  EXPECT_LT((D.V_W - state.handle[1].V_W).norm(), 1e-12);
}

// Without damping and friction, only the hands' work changes the energy.
TEST(World, HandsWorkBecomesEnergy) {
  const Scenario s = Frictionless(9, 0);
  World world(s);
  const double start = world.state().energy;
  double work = 0;
  for (int i = 0; i < 1500; ++i) {
    WorldInput input = Push(s, Vector3(6 * std::sin(0.006 * i), 4, 8 * std::cos(0.004 * i)));
    input.F_H_W[1].tail<3>() = Vector3(0.1, -0.2, 0.3);
    const auto before = world.state().handle;
    ASSERT_TRUE(world.Step(input, kTick).ok());
    for (std::size_t h = 0; h < kHands; ++h) {
      const Twist mean = 0.5 * (before[h].V_W + world.state().handle[h].V_W);
      work += kTick * input.F_H_W[h].dot(mean);
    }
  }
  EXPECT_GT(std::abs(work), 0.5);
  EXPECT_NEAR(world.state().energy - start, work, 0.01 * std::abs(work));
}

// With damping, but without friction and hands, the energy must not rise relative to the energy of
// the equilibrium.
TEST(World, IsPassive) {
  for (const double posture : {0.0, 10.0}) {
    Scenario s = Frictionless(9, 0.7);
    s.cobot.controller.Set("posture_stiffness=" + FormatNumber(posture));
    World world(s);
    const double rest = world.state().energy;
    Simulate(&world, Push(s, {8, 5, 15}), 0.5);
    const double initial = world.state().energy - rest;
    ASSERT_GT(initial, 0.1);
    std::vector<double> energies;
    Simulate(&world, HandsOff(s), 10,
             [&](const WorldState& state) { energies.push_back(state.energy); });
    double rise = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 1000; i < energies.size(); ++i) {
      rise = std::max(rise, energies[i] - energies[i - 1000]);
    }
    EXPECT_LE(rise, 1e-6 * initial) << "posture stiffness " << posture;
    EXPECT_LT(energies.back() - rest, 0.5 * initial);
  }
}

TEST(World, SubStepsMakeALongTick) {
  const Scenario s = BoxScene(9);
  World fine(s), coarse(s);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(coarse.Step(Push(s, {5, 5, 5}), 0.004).ok());
  }
  Simulate(&fine, Push(s, {5, 5, 5}), 0.4);
  EXPECT_TRUE(Same(fine.state(), coarse.state()));
  EXPECT_NEAR(coarse.state().time, 0.4, 1e-12);
}

TEST(World, ResetRepeatsBitForBit) {
  const Scenario s = BoxScene(9);
  World world(s);
  const WorldState start = world.state();
  Simulate(&world, Push(s, {5, -3, 10}), 0.7);
  const WorldState first = world.state();
  EXPECT_FALSE(Same(first, start));
  world.Reset();
  EXPECT_TRUE(Same(world.state(), start));
  Simulate(&world, Push(s, {5, -3, 10}), 0.7);
  EXPECT_TRUE(Same(world.state(), first));
  World another(s);
  Simulate(&another, Push(s, {5, -3, 10}), 0.7);
  EXPECT_TRUE(Same(another.state(), first));
}

// A stop by the simulation states a value that exceeds its limit, or no value.
void ExpectSaysWhatDiverged(const Status& status) {
  EXPECT_NE(status.quantity, Quantity::kNone);
  if (status.quantity == Quantity::kNotFinite) return;
  EXPECT_TRUE(std::isfinite(status.value));
  EXPECT_GT(status.value, status.limit);
}

TEST(World, DiscardsAStepThatIsNotFiniteOrDiverges) {
  const Scenario s = BoxScene(9);
  for (const double force : {1e12, 1e300, std::nan(""), std::numeric_limits<double>::infinity()}) {
    World world(s), reference(s);
    Simulate(&world, Push(s, {5, -3, 10}), 0.2);
    Simulate(&reference, Push(s, {5, -3, 10}), 0.2);
    const WorldState before = world.state();
    const Status status = world.Step(Push(s, {force, 0, 0}), 0.002);
    EXPECT_EQ(status.cause, StopCause::kPhysics);
    ExpectSaysWhatDiverged(status);
    EXPECT_TRUE(Same(world.state(), before));
    Simulate(&world, Push(s, {5, -3, 10}), 0.2);
    Simulate(&reference, Push(s, {5, -3, 10}), 0.2);
    EXPECT_TRUE(Same(world.state(), reference.state()));
  }
}

TEST(World, SaysThatANumberOfAStepIsNotFinite) {
  const Scenario s = BoxScene(9);
  World world(s);
  for (const double force : {std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(world.Step(Push(s, {force, 0, 0}), 0.002).quantity, Quantity::kNotFinite);
}

// The friction in the joints is so large that the implicit integrator turns a very large
// acceleration into a small change of the velocity. At rest, an acceleration is nearly proportional
// to a large force, so the first refused one exceeds its limit by little more than a step of the
// force.
TEST(World, StatesTheAccelerationThatIsTooLarge) {
  Scenario s = FlangeScene("cartesian_impedance", {});
  s.cobot.joint_friction.viscous = {1e5};
  World world(s);
  Status status;
  for (double force = 1e3; status.ok(); force *= 1.1) {
    ASSERT_LT(force, 1e9);
    world.Reset();
    status = world.Step(Push(s, {force, 0, 0}), 0.001);
  }
  EXPECT_EQ(status.cause, StopCause::kPhysics);
  EXPECT_EQ(status.quantity, Quantity::kAngularAcceleration);
  EXPECT_EQ(status.limit, 1e6);
  EXPECT_GT(status.value, 1e6);
  EXPECT_LT(status.value, 1.15e6);
}

TEST(World, JointTorquesStayWithinTheEffortLimits) {
  Scenario s = BoxScene(9);
  s.cobot.effort_limit = {};
  s.cobot.controller.Set("stiffness.rotation=[2000, 2000, 2000]");
  s.cobot.controller.Set("stiffness.translation=[3000, 3000, 3000]");
  World world(s);
  const ControlledRobot robot(s);
  bool limited = false;
  Simulate(&world, Push(s, {200, 100, -100}), 0.3, [&](const WorldState& state) {
    const auto share = (state.torque.array().abs() / robot.model->effort_limit().array()).eval();
    EXPECT_LE(share.maxCoeff(), 1);
    limited = limited || share.maxCoeff() == 1;
  });
  EXPECT_TRUE(limited);
}

TEST(World, TableHoldsTheBoxThatFallsOnIt) {
  Scenario s = BoxScene(9);
  s.environment.table = TableSpec{};
  s.cobot.base.xyz = {0, 0, 0.5};
  World hanging(s);
  const double bottom = hanging.state().object.X_W.p.z() - 0.1;
  s.environment.table->top = {0.5, 0, bottom - 0.03};
  World world(s);
  double lowest = bottom;
  Simulate(&world, Push(s, {0, 0, -40}), 2.0, [&](const WorldState& state) {
    lowest = std::min(lowest, state.object.X_W.p.z() - 0.1);
  });
  EXPECT_GT(lowest, bottom - 0.03 - 0.005);
  EXPECT_NEAR(world.state().object.X_W.p.z() - 0.1, bottom - 0.03, 0.002);
  EXPECT_LT(world.state().object.V_W.norm(), 1e-3);
}

// The table carries the full weight of the box. The box must slide if the hands pull harder than μ
// m g = 71 N.
TEST(World, TableHoldsByFriction) {
  Scenario s = BoxScene(9);
  s.cobot.controller.Set("stiffness.translation=[5, 5, 0]");
  s.environment.table = TableSpec{};
  s.environment.table->top = {0.5, 0, 0.97};
  World world(s);
  EXPECT_NEAR(world.state().object.X_W.p.z(), 1.07, 0.002);
  const Vector3 start = world.state().object.X_W.p;
  Simulate(&world, Push(s, {25, 0, 0}), 0.3);
  EXPECT_LT((world.state().object.X_W.p - start).norm(), 0.005);
  Simulate(&world, Push(s, {45, 0, 0}), 0.3);
  EXPECT_GT((world.state().object.X_W.p - start).norm(), 0.02);
}

// A hand of mass m on a handle must have the same effect as a reduction of the hand's force by m·a.
TEST(World, HandMassInDirectModeIsItsInertia) {
  Scenario direct = BoxScene(9);
  direct.mode = Mode::kDirect;
  const Scenario plain = BoxScene(9);
  const double mass = 2;
  World heavy(direct), light(plain);
  EXPECT_LT((heavy.state().object.X_W.p - light.state().object.X_W.p).norm(), 1e-9);
  WorldInput input = HandsOff(direct);
  input.F_H_W[0] << 3, -5, 8, 0, 0, 0;
  input.hand_mass = {mass, 0};
  ASSERT_TRUE(heavy.Step(input, kTick).ok());
  WorldInput equivalent = HandsOff(plain);
  const Vector6 A = heavy.state().handle[0].A_W;
  equivalent.F_H_W[0] = input.F_H_W[0];
  equivalent.F_H_W[0].head<3>() -= mass * A.head<3>();
  equivalent.F_H_W[0].tail<3>() -= 0.4 * mass * 0.04 * 0.04 * A.tail<3>();
  ASSERT_TRUE(light.Step(equivalent, kTick).ok());
  EXPECT_LT((light.state().handle[0].A_W - A).norm(), 1e-3 * A.norm());
  EXPECT_GT(mass * A.head<3>().norm(), 0.5);
  // The hand's mass has no weight, so the box must not move without a force.
  heavy.Reset();
  input.F_H_W[0].setZero();
  const Vector3 start = heavy.state().object.X_W.p;
  Simulate(&heavy, input, 1.0);
  EXPECT_LT((heavy.state().object.X_W.p - start).norm(), 1e-8);
}

// Coulomb friction must resist small forces, except for the creep of the engine's soft constraint.
TEST(World, CoulombFrictionHoldsSmallForces) {
  Scenario s = EmptyScene();
  s.cobot.controller.Set("stiffness.translation=[0, 0, 500]");
  s.cobot.controller.Set("stiffness.rotation=[0, 0, 0]");
  s.cobot.controller.Set("posture_stiffness=0");
  s.cobot.joint_friction.coulomb = {2};
  World world(s);
  const Vector3 start = world.state().end_effector.X_W.p;
  Simulate(&world, Push(s, {1, 1, 0}), 1.0);
  const double held = (world.state().end_effector.X_W.p - start).norm();
  Simulate(&world, Push(s, {15, 15, 0}), 0.5);
  const double moved = (world.state().end_effector.X_W.p - start).norm();
  EXPECT_LT(held, 0.001);
  EXPECT_GT(moved, 0.1);
}

TEST(World, FollowsItsTrajectory) {
  Scenario s = EmptyScene();
  s.cobot.controller.Set("stiffness.translation=[500, 500, 500]");
  s.cobot.controller.Set("trajectory=[{time: 1.5, xyz: [0.1, 0.1, -0.05], rpy: [0, 0, 0.4]}]");
  World world(s);
  const Pose start = world.state().end_effector.X_W;
  Simulate(&world, HandsOff(s), 3.0);
  const Pose end = world.state().end_effector.X_W;
  EXPECT_LT((end.p - start.p - Vector3(0.1, 0.1, -0.05)).norm(), 1e-4);
  EXPECT_LT((RotationError(end.q, start.q) - Vector3(0, 0, 0.4)).norm(), 1e-3);
}

TEST(World, TextOfTheSceneNamesWhatIsInIt) {
  Scenario s = BoxScene(9);
  s.environment.floor = true;
  const std::string xml = World(s).SceneXml();
  for (const char* name :
       {"cobot/panda_link8", "object", "left_handle", "right_handle", "floor", "mass=\"9\""}) {
    EXPECT_NE(xml.find(name), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace predictor
