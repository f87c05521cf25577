#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/random.h"
#include "scenes.h"
#include "simulation/controller.h"

namespace predictor {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Scenario Impedance() {
  Scenario s = PandaScene();
  s.cobot.controller.Set("stiffness.translation=[300, 80, 500]");
  s.cobot.controller.Set("stiffness.rotation=[20, 60, 5]");
  s.cobot.controller.Set("damping_ratio=0.7");
  return s;
}

JointVector Random(RandomStream* random, double scale) {
  JointVector x(7);
  for (int j = 0; j < 7; ++j) x[j] = scale * random->Normal();
  return x;
}

MatrixXd Inverse(const MatrixXd& A) { return Solve(A, MatrixXd::Identity(A.rows(), A.cols())); }

MatrixXd JacobianOf(const ControlledRobot& robot) {
  Jacobian J;
  robot.data.FrameJacobian(*robot.model, robot.end_effector, &J);
  return J;
}

// Computes Λ with plain inverses.
MatrixXd CartesianInertia(const ControlledRobot& robot) {
  const MatrixXd J = JacobianOf(robot);
  return Inverse(J * Inverse(robot.data.M()) * J.transpose());
}

// Computes D column by column from the torques: Jᵀ D J v = τ(0) − τ(v).
MatrixXd DampingInJoints(ControlledRobot* robot) {
  const JointVector q = robot->q;
  MatrixXd D(7, 7);
  robot->Update(q, JointVector::Zero(7));
  const VectorXd still = robot->Torque();
  for (int j = 0; j < 7; ++j) {
    robot->Update(q, JointVector::Unit(7, j));
    D.col(j) = still - VectorXd(robot->Torque());
  }
  robot->Update(q, JointVector::Zero(7));
  return D;
}

TEST(Controllers, AreFoundByName) {
  const std::vector<std::string> names = ControllerNames();
  EXPECT_GE(names.size(), 3u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  Scenario s = PandaScene();
  s.cobot.controller = {"cartesian_impedence", {}};
  try {
    ControlledRobot robot(s);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cartesian_impedance"), std::string::npos);
  }
}

// Returns the error message if the controller cannot be created, or "".
std::string ErrorOf(const std::string& type, const std::string& parameter) {
  Scenario s = PandaScene();
  s.cobot.controller = {type, {}};
  s.cobot.controller.Set(parameter);
  try {
    ControlledRobot robot(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Controllers, RefuseListsOfTheWrongLength) {
  EXPECT_NE(ErrorOf("cartesian_impedance", "damping_ratio=[0.7, 0.7]"), "");
  EXPECT_EQ(ErrorOf("joint_impedance", "joint_stiffness=[1, 2, 3]"),
            "cobot.controller.joint_stiffness has 3 values. Give one for all, or 7.");
}

TEST(Controllers, RefuseWaypointsThatDoNotIncreaseInTime) {
  for (const char* type : {"admittance", "cartesian_impedance", "hybrid_force_position"})
    EXPECT_EQ(ErrorOf(type, "trajectory=[{time: 2}, {time: 1}]"),
              "cobot.controller.trajectory.1.time is 1 s, which does not come after 2 s. Give "
              "increasing times, of which the first is greater than 0.");
  EXPECT_NE(ErrorOf("cartesian_impedance", "trajectory=[{time: 0}]"), "");
}

TEST(Controllers, RefuseParametersThatTheyDoNotHave) {
  for (const char* type : {"joint_impedance", "gravity_compensation"})
    EXPECT_NE(ErrorOf(type, "trajectory=[{time: 1}]").find("\"trajectory\" is not a key"),
              std::string::npos);
}

TEST(CartesianImpedance, CarriesOnlyTheWeightAtTheSetPoint) {
  ControlledRobot robot(Impedance());
  EXPECT_LT((robot.Torque() - robot.data.gravity()).norm(), 1e-9);
  EXPECT_LT(robot.Energy(), 1e-18);
}

// Spring torques must equal the negative gradient of the springs' energy, even far from the
// set-point and with a different rotational stiffness about each axis.
TEST(CartesianImpedance, SpringsAreTheGradientOfTheirEnergy) {
  Scenario s = Impedance();
  s.cobot.controller.Set("posture_stiffness=0");
  ControlledRobot robot(s);
  RandomStream random(1, "gradient");
  const double h = 1e-6;
  for (int i = 0; i < 20; ++i) {
    const JointVector q = robot.posture + Random(&random, 0.3);
    VectorXd gradient(7);
    for (int j = 0; j < 7; ++j) {
      robot.Update(q + h * JointVector::Unit(7, j), JointVector::Zero(7));
      const double ahead = robot.Energy();
      robot.Update(q - h * JointVector::Unit(7, j), JointVector::Zero(7));
      gradient[j] = (ahead - robot.Energy()) / (2 * h);
    }
    robot.Update(q, JointVector::Zero(7));
    const VectorXd springs = robot.Torque() - robot.data.gravity();
    EXPECT_LT((springs + gradient).norm(), 1e-6 * (1 + gradient.norm()));
  }
}

// Near the set-point, the wrench on E must be K times the error, in W's axes.
TEST(CartesianImpedance, StiffnessIsThatAskedForPerAxis) {
  Scenario s = Impedance();
  s.cobot.controller.Set("posture_stiffness=0");
  ControlledRobot robot(s);
  RandomStream random(2, "stiffness");
  const Pose set_point = robot.data.FramePose(*robot.model, robot.end_effector);
  const Vector6 K = (Vector6() << 300, 80, 500, 20, 60, 5).finished();
  for (int i = 0; i < 5; ++i) {
    robot.Update(robot.posture + Random(&random, 1e-5), JointVector::Zero(7));
    const Vector6 e = PoseError(set_point, robot.data.FramePose(*robot.model, robot.end_effector));
    const VectorXd expected = JacobianOf(robot).transpose() * K.cwiseProduct(e);
    EXPECT_LT((robot.Torque() - robot.data.gravity() - expected).norm(), 1e-4 * expected.norm());
  }
}

// Compares the damping by double diagonalisation with the solution of a generalised eigenproblem by
// another method.
TEST(CartesianImpedance, DampingIsDoublyDiagonal) {
  Scenario s = Impedance();
  s.cobot.controller.Set("posture_stiffness=0");
  ControlledRobot robot(s);
  RandomStream random(3, "damping");
  const Vector6 K = (Vector6() << 300, 80, 500, 20, 60, 5).finished();
  for (int i = 0; i < 10; ++i) {
    robot.Update(robot.posture + Random(&random, 0.3), JointVector::Zero(7));
    const MatrixXd Lambda = CartesianInertia(robot);
    const MatrixXd J = JacobianOf(robot);
    const SymmetricModes modes = SymmetricModesOf(K.asDiagonal(), Lambda);
    // If the modes W are scaled so that Wᵀ Λ W = 1, then D = Λ W (2 ζ √K0) Wᵀ Λ.
    const MatrixXd& W = modes.eigenvectors;
    const VectorXd d = 2 * 0.7 * modes.eigenvalues.cwiseSqrt();
    const MatrixXd D = Lambda * W * d.asDiagonal() * W.transpose() * Lambda;
    const MatrixXd expected = J.transpose() * D * J;
    EXPECT_LT((DampingInJoints(&robot) - expected).norm(), 1e-6 * expected.norm());
  }
}

// A mode that moves along a single axis must have the damping ratio of this axis. All modes lie
// between the smallest and the largest ratio.
TEST(CartesianImpedance, RatioPerAxisReachesTheModesOfThatAxis) {
  Scenario s = Impedance();
  s.cobot.controller.Set("posture_stiffness=0");
  s.cobot.controller.Set("stiffness.translation=[0, 0, 500]");
  s.cobot.controller.Set("stiffness.rotation=[0, 0, 0]");
  s.cobot.controller.Set("damping_ratio=[0.1, 0.2, 0.9, 0.3, 0.4, 0.5]");
  ControlledRobot robot(s);
  const MatrixXd D = DampingInJoints(&robot);
  // One spring causes one mode. The inertia of this mode along z is 1/(Λ⁻¹)_zz, and D is of rank
  // one.
  const MatrixXd J = JacobianOf(robot);
  const MatrixXd Lambda = CartesianInertia(robot);
  const MatrixXd mobility = Inverse(Lambda);
  const double inertia = 1 / mobility(2, 2);
  const VectorXd moved = mobility.col(2) * inertia;  // the mode: 1 m along z
  const VectorXd q = J.transpose() * Solve(J * J.transpose(), moved);
  EXPECT_NEAR(q.dot(D * q), 2 * 0.9 * std::sqrt(500 * inertia), 1e-6);
}

TEST(CartesianImpedance, DampingNeverDrives) {
  Scenario s = Impedance();
  s.cobot.controller.Set("damping_ratio=[0.1, 1.2, 0.9, 0.3, 0.02, 0.5]");
  s.cobot.controller.Set("posture_stiffness=20");
  ControlledRobot robot(s);
  RandomStream random(4, "passive");
  for (int i = 0; i < 20; ++i) {
    robot.Update(robot.posture + Random(&random, 0.4), JointVector::Zero(7));
    const MatrixXd D = DampingInJoints(&robot);
    EXPECT_LT((D - D.transpose()).norm(), 1e-8 * D.norm());
    const SymmetricModes modes = SymmetricModesOf(D, MatrixXd::Identity(7, 7));
    EXPECT_GT(modes.eigenvalues.minCoeff(), -1e-9 * D.norm());
  }
}

// The torques that pull towards the posture, and their damping, must not accelerate E.
TEST(CartesianImpedance, PostureTorqueDoesNotMoveTheEndEffector) {
  Scenario with = Impedance();
  with.cobot.controller.Set("posture_stiffness=30");
  Scenario without = with;
  without.cobot.controller.Set("posture_stiffness=0");
  ControlledRobot a(with), b(without);
  RandomStream random(5, "null space");
  for (int i = 0; i < 10; ++i) {
    const JointVector q = a.posture + Random(&random, 0.3);
    const JointVector v = Random(&random, 0.5);
    a.Update(q, v);
    b.Update(q, v);
    const VectorXd posture = a.Torque() - b.Torque();
    EXPECT_GT(posture.norm(), 0.1);
    const VectorXd acceleration = JacobianOf(a) * Solve(a.data.M(), posture);
    EXPECT_LT(acceleration.norm(), 1e-5 * posture.norm());
  }
}

// A stretched arm cannot move outwards. Λ is unbounded there, but the torques must be bounded.
TEST(CartesianImpedance, StaysBoundedInSingularPostures) {
  Scenario s = Impedance();
  ControlledRobot robot(s);
  JointVector stretched = JointVector::Zero(7);
  for (const double bend : {0.0, 1e-9, 1e-6, 1e-3, 1e-2}) {
    stretched[3] = -bend;
    robot.Update(stretched, JointVector::Constant(7, 0.1));
    const JointVector torque = robot.Torque();
    ASSERT_TRUE(torque.allFinite());
    EXPECT_LT((torque - robot.data.gravity()).norm(), 500);
  }
}

// The set-point's acceleration is multiplied by Λ, so E must follow it exactly from rest.
TEST(CartesianImpedance, FeedsTheSetPointsAccelerationForward) {
  Scenario s = Impedance();
  s.cobot.controller.Set("trajectory=[{time: 1, xyz: [0.1, 0.05, -0.1], rpy: [0.2, 0, 0.3]}]");
  ControlledRobot robot(s);
  const double h = 1e-3;  // so short that the springs and dampers have no noticeable effect
  const VectorXd tau = robot.Torque(h) - robot.data.gravity();
  const VectorXd acceleration = JacobianOf(robot) * Solve(robot.data.M(), tau);
  const Vector3 expected = 60 * h * (1 - h) * (1 - 2 * h) * Vector3(0.1, 0.05, -0.1);
  EXPECT_LT((acceleration.head<3>() - expected).norm(), 0.01 * expected.norm());
}

TEST(JointImpedance, MatchesTheClosedForm) {
  Scenario s = PandaScene();
  s.cobot.controller = {"joint_impedance", {}};
  s.cobot.controller.Set("joint_stiffness=[100, 90, 80, 70, 30, 20, 10]");
  s.cobot.controller.Set("joint_damping_ratio=0.4");
  ControlledRobot robot(s);
  RandomStream random(6, "joints");
  const VectorXd K = (VectorXd(7) << 100, 90, 80, 70, 30, 20, 10).finished();
  for (int i = 0; i < 10; ++i) {
    const JointVector q = robot.posture + Random(&random, 0.3);
    const JointVector v = Random(&random, 1);
    robot.Update(q, v);
    const MatrixXd M = robot.data.M();
    const SymmetricModes modes = SymmetricModesOf(K.asDiagonal(), M);
    const MatrixXd MW = M * modes.eigenvectors;
    const VectorXd d = 2 * 0.4 * modes.eigenvalues.cwiseSqrt();
    const VectorXd damping = MW * d.asDiagonal() * MW.transpose() * VectorXd(v);
    const VectorXd e = robot.posture - q;
    const VectorXd expected = VectorXd(robot.data.gravity()) + K.cwiseProduct(e) - damping;
    EXPECT_LT((VectorXd(robot.Torque()) - expected).norm(), 1e-8 * expected.norm());
    EXPECT_NEAR(robot.Energy(), 0.5 * e.dot(K.cwiseProduct(e)), 1e-10);
  }
}

// The torques must depend only on the weight of the links, regardless of velocity.
TEST(GravityCompensation, CarriesTheLinks) {
  Scenario s = PandaScene();
  s.cobot.controller = {"gravity_compensation", {}};
  ControlledRobot robot(s);
  RandomStream random(7, "gravity");
  robot.Update(robot.posture + Random(&random, 0.3), Random(&random, 1));
  EXPECT_LT((robot.Torque() - robot.data.gravity()).norm(), 1e-12);
  EXPECT_GT(robot.Torque().norm(), 1);
  EXPECT_EQ(robot.Energy(), 0);
}

}  // namespace
}  // namespace predictor
