// Compares the controllers that follow a trajectory, except cartesian_impedance, with the closed
// forms of their laws.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "simulation/controllers/set_point.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

const std::vector<Waypoint> kWaypoints = {{2, {0.1, 0.05, -0.04}, {0, 0, 0.2}},
                                          {3.5, {0, 0.1, 0}, {0.1, 0, 0}}};
constexpr const char* kTrajectory =
    "trajectory=[{time: 2, xyz: [0.1, 0.05, -0.04], rpy: [0, 0, 0.2]}, "
    "{time: 3.5, xyz: [0, 0.1, 0], rpy: [0.1, 0, 0]}]";

// ---- admittance --------------------------------------------------------------------------------

// An admittance whose sensor reads a constant wrench F from the start on. V and x are in its
// memory.
class AdmittanceUnderForce {
 public:
  AdmittanceUnderForce(const std::vector<std::string>& parameters, const Wrench& F)
      : robot_(FlangeScene("admittance", parameters)), F_(F) {
    robot_.controller->Start(robot_.Input(0));
  }
  void AdvanceTo(double time) {
    for (; time_ < time - kStep / 2; time_ += kStep) {
      ControllerInput input = robot_.Input(time_);
      input.F_E_W = F_;
      robot_.controller->Advance(input, kStep);
    }
  }
  Vector6 V() { return Vector6::Map(robot_.controller->memory().data()); }
  Vector6 x() { return Vector6::Map(robot_.controller->memory().data() + 6); }
  double Energy() { return robot_.Energy(time_); }
  SetPointTrajectory set_point() const { return {kWaypoints, robot_.E.X_W}; }

 private:
  static constexpr double kStep = 1e-4;  // [s]
  ControlledRobot robot_;
  Wrench F_;
  double time_ = 0;
};

// Without stiffness, the error of the speed is F/D_d (1 − exp(−D_d t / M_d)), however the set-point
// moves.
TEST(MovingAdmittance, SpeedErrorIsThatOfADampedMass) {
  const Wrench F = (Wrench() << 3, -6, 2, 0.1, 0.2, -0.1).finished();
  AdmittanceUnderForce admittance({"virtual_mass=8", "virtual_inertia=0.3",
                                   "damping_translation=60", "damping_rotation=2", kTrajectory},
                                  F);
  const SetPointTrajectory set_point = admittance.set_point();
  for (const double t : {0.1, 0.5, 1.0, 1.9, 2.7, 4.0}) {
    admittance.AdvanceTo(t);
    const Vector6 error = admittance.V() - set_point.At(t).V_W;
    for (int i = 0; i < 6; ++i) {
      const double D = i < 3 ? 60 : 2, M = i < 3 ? 8 : 0.3;
      EXPECT_NEAR(error[i], F[i] / D * (1 - std::exp(-D / M * t)), 2e-3 * std::abs(F[i] / D))
          << t << " s, axis " << i;
    }
  }
}

// With stiffness and without force, V and x are those of the set-point at any time. A constant
// force then displaces x by F/K_d.
TEST(MovingAdmittance, PositionErrorIsForceOverStiffness) {
  const std::vector<std::string> parameters = {
      "virtual_stiffness={translation: [300, 200, 100], rotation: [10, 20, 30]}", kTrajectory};
  AdmittanceUnderForce free(parameters, Wrench::Zero());
  const SetPointTrajectory set_point = free.set_point();
  for (const double t : {0.7, 1.3, 2.6, 4.0}) {
    free.AdvanceTo(t);
    EXPECT_LT((free.V() - set_point.At(t).V_W).norm(), 1e-4) << t;
    EXPECT_LT((free.x() - set_point.PathAt(t)).norm(), 1e-4) << t;
  }
  const Wrench F = (Wrench() << 3, -6, 2, 0.1, 0.2, -0.3).finished();
  const Vector6 K = (Vector6() << 300, 200, 100, 10, 20, 30).finished();
  AdmittanceUnderForce pushed(parameters, F);
  pushed.AdvanceTo(12);
  const Vector6 e = F.cwiseQuotient(K);
  EXPECT_LT((pushed.x() - set_point.PathAt(12) - e).norm(), 1e-6);
  EXPECT_NEAR(pushed.Energy(), 0.5 * e.dot(K.cwiseProduct(e)), 1e-6);
}

// The position loop has no acceleration feedforward, so it lags behind by A/ω². Another millisecond
// passes between the reference and the motion.
TEST(MovingAdmittance, TheCobotFollowsTheSetPoint) {
  Scenario s = EmptyScene();
  s.cobot.controller = {"admittance", {}};
  s.cobot.controller.Set("inner_frequency=10");
  s.cobot.controller.Set(kTrajectory);
  World world(s);
  const SetPointTrajectory set_point(kWaypoints, world.state().end_effector.X_W);
  const double omega = 2 * M_PI * 10;
  const double lag = 0.35 / (omega * omega) + 2 * kTick * 0.15;  // at most 0.35 m/s², 0.15 m/s
  Simulate(&world, HandsOff(s), 4, [&](const WorldState& state) {
    const Vector3 error = state.end_effector.X_W.p - set_point.At(state.time).X_W.p;
    ASSERT_LT(error.norm(), lag) << state.time;
  });
  EXPECT_LT(PoseError(set_point.At(4).X_W, world.state().end_effector.X_W).norm(), 1e-3);
}

// An admittance that takes over at rest in the middle of its trajectory must not draw the
// end-effector back to the set-point.
TEST(MovingAdmittance, TakesOverWhereTheEndEffectorIs) {
  ControlledRobot robot(
      FlangeScene("admittance", {"virtual_stiffness={translation: [300, 300, 300]}", kTrajectory}));
  robot.controller->Start(robot.Input(0));
  ControllerInput input = robot.Input(2);  // the set-point rests at the first waypoint
  const JointVector torque = robot.data.gravity();
  input.torque = &torque;
  robot.controller->TakeOver(input);
  EXPECT_EQ(robot.Energy(2), 0);
  robot.controller->Advance(input, 1e-3);
  EXPECT_LT(Vector6::Map(robot.controller->memory().data()).norm(), 1e-9);
}

// A jump of the set-point by j changes only x_d. Without force, x then follows the critically
// damped oscillator M ẍ + D ẋ + K (x − j) = 0 with ω = √(K/M): x = j (1 − (1 + ω t) exp(−ω t)).
TEST(MovingAdmittance, JumpIsTheStepResponseOfTheVirtualSpring) {
  ControlledRobot robot(
      FlangeScene("admittance", {"virtual_mass=8", "damping_translation=80",
                                 "virtual_stiffness={translation: [200, 200, 200]}"}));
  robot.controller->Start(robot.Input(0));
  const Vector6 jump = (Vector6() << 0.02, 0, -0.05, 0, 0, 0).finished();
  robot.controller->ShiftSetPoint(jump);
  EXPECT_NEAR(robot.Energy(0), 0.5 * 200 * jump.squaredNorm(), 1e-12);
  const double dt = 1e-4, omega = std::sqrt(200.0 / 8);
  for (int k = 1; k <= 20'000; ++k) {
    robot.controller->Advance(robot.Input(0), dt);
    if (k % 2500 != 0) continue;
    const double t = k * dt, share = 1 - (1 + omega * t) * std::exp(-omega * t);
    const Vector6 x = Vector6::Map(robot.controller->memory().data() + 6);
    EXPECT_LT((x - share * jump).norm(), 2e-3 * jump.norm()) << t;
  }
  robot.controller->ResetTuning();
  robot.controller->Start(robot.Input(0));
  EXPECT_EQ(robot.Energy(0), 0);
}

// ---- hybrid force/position ---------------------------------------------------------------------

// The torques are compared with the law, written axis by axis.
TEST(MovingHybrid, TorquesFollowTheLaw) {
  ControlledRobot robot(FlangeScene(
      "hybrid_force_position",
      {"force_axes=y", "set_force=[0, 7, 0]", "force_gain=0", "stiffness_translation=[400, 1, 900]",
       "damping_translation=30", "damping_rotation=4", "stiffness_rotation=80", kTrajectory}));
  const SetPointTrajectory set_point(kWaypoints, robot.E.X_W);
  RandomStream random(4, "hybrid");
  for (const double t : {0.0, 0.6, 1.4, 2.5, 5.0}) {
    JointVector q = robot.posture, v = JointVector::Zero(7);
    for (int j = 0; j < 7; ++j) q[j] += 0.1 * random.Normal(), v[j] = 0.3 * random.Normal();
    robot.Update(q, v);
    const FrameMotion d = set_point.At(t);
    const Twist V = robot.E.V_W;
    const Vector3 p = robot.E.X_W.p;
    Wrench F;
    F[0] = 400 * (d.X_W.p.x() - p.x()) + 30 * (d.V_W[0] - V[0]);
    F[1] = 7 - 30 * V[1];  // the set-point has no effect along y
    F[2] = 900 * (d.X_W.p.z() - p.z()) + 30 * (d.V_W[2] - V[2]);
    const Eigen::AngleAxisd turn(d.X_W.q * robot.E.X_W.q.conjugate());
    F.tail<3>() = 80 * turn.angle() * turn.axis() + 4 * (d.V_W - V).tail<3>();
    Jacobian J;
    robot.data.FrameJacobian(*robot.model, robot.end_effector, &J);
    const JointVector expected = robot.data.gravity() + J.transpose() * F;
    EXPECT_LT((robot.Torque(t) - expected).norm(), 1e-9 * expected.norm()) << t;
  }
}

// The cobot carries the box with the set force, and the spring leads it to the waypoint. The hand
// displaces it from there by F/K.
TEST(MovingHybrid, ReachesTheWaypointAlongTheOtherAxes) {
  Scenario s =
      FlangeScene("hybrid_force_position",
                  {"set_force=[0, 0, 19.62]", "stiffness_translation=[400, 800, 0]",
                   "damping_translation=80", "trajectory=[{time: 2, xyz: [0.06, -0.05, 0.3]}]"});
  s.cobot.joint_friction.viscous = {0};
  World world(s);
  const Vector3 start = world.state().end_effector.X_W.p;
  WorldInput input = HandsOff(s);
  input.F_H_W[0].head<3>() = Vector3(6, -8, 0);
  Simulate(&world, input, 5);
  const Vector3 moved = world.state().end_effector.X_W.p - start;
  EXPECT_NEAR(moved.x(), 0.06 + 6.0 / 400, 1e-4);
  EXPECT_NEAR(moved.y(), -0.05 - 8.0 / 800, 1e-4);
  EXPECT_LT(std::abs(moved.z()), 0.02);  // the set-point does not raise the force-controlled axis
}

}  // namespace
}  // namespace predictor
