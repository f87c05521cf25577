#include "muscles/stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "muscles/arms.h"

namespace predictor::muscles {
namespace {

// Returns the torque of springs. The springs have the rates k, and their forces at posture q0 are
// F.
ArmVector SpringTorque(const ArmModel& arm, const ArmVector& q, const MuscleVector& force,
                       const MuscleVector& k, const MuscleVector& length0) {
  const MuscleLines lines = arm.LinesAt(q);
  return lines.moment_arm * (force + k.cwiseProduct(lines.length - length0));
}

// Compares K = -∂τ/∂q of muscles that act as springs with differences of the springs' torque.
TEST(Stiffness, OfTheJointsIsTheSlopeOfTheTorque) {
  constexpr double kStep = 1e-5;
  const ArmModel arm({}, 0);
  RandomStream random(5, "stiffness");
  int kinks = 0;
  for (int n = 0; n < 20; ++n) {
    const ArmVector q = RandomArm(arm, &random, 0.5);
    MuscleVector active, k;
    for (int i = 0; i < kMuscles; ++i) {
      active[i] = 100 * random.Uniform();
      k[i] = kShortRangeStiffness * active[i] / arm.muscle(i).fibre_length;
    }
    const MuscleVector force = active + MuscleVector::Constant(20);
    const MuscleVector length0 = arm.LinesAt(q).length;
    const ArmMatrix K = JointStiffness(arm, q, active, force);
    for (int j = 0; j < person::kArmJoints; ++j) {
      const ArmVector step = kStep * ArmVector::Unit(j);
      const ArmVector slope = -(SpringTorque(arm, q + step, force, k, length0) -
                                SpringTorque(arm, q - step, force, k, length0)) /
                              (2 * kStep);
      const double error = (slope - K.col(j)).cwiseAbs().maxCoeff() / K.cwiseAbs().maxCoeff();
      EXPECT_LT(error, 0.01);
      kinks += error > 1e-4 ? 1 : 0;
    }
  }
  EXPECT_LE(kinks, 5);  // of 140, because a path begins to touch its obstacle within the step
}

person::BodyVector BodyAt(const ArmVector& q, int hand) {
  person::BodyVector all = person::BodyVector::Zero();
  all.segment<person::kArmJoints>(person::Of(hand, person::ArmJoint::kShoulderFlexion)) = q;
  all[person::kTorsoFlexion] = 0.2;
  return all;
}

HandPoint PointAt(const ArmModel& arm, const ArmVector& q, const Vector3& force) {
  const person::Placement at = person::Place(arm.body(), BodyAt(q, arm.hand()));
  const int last = person::Of(arm.hand(), person::ArmJoint::kWristDeviation);
  return HandPointAt(arm.body(), at, arm.hand(), at.FrameOf(last) * Vector3(0, 0, -0.08), force);
}

TEST(Stiffness, TheForceOnTheHandTurnsWithTheJoints) {
  constexpr double kStep = 1e-6;
  const ArmModel arm({}, 1);
  const ArmVector q = WorkPosture();
  const Vector3 force(10, -20, 30);
  const HandPoint point = PointAt(arm, q, force);
  for (int j = 0; j < person::kArmJoints; ++j) {
    const ArmVector step = kStep * ArmVector::Unit(j);
    const auto torque = [&](const ArmVector& at) -> ArmVector {
      return PointAt(arm, at, force).J.topRows<3>().transpose() * force;
    };
    const ArmVector slope = (torque(q + step) - torque(q - step)) / (2 * kStep);
    EXPECT_LT((slope - point.turning.col(j)).cwiseAbs().maxCoeff(), 1e-6);
  }
}

// If the hand is held at a displacement, minimising the joints' energy must give the same
// stiffness.
TEST(Stiffness, OfTheHandIsThatOfTheJointsUnderTheHeldHandle) {
  const ArmModel arm({}, 1);
  const ArmVector q = WorkPosture();
  ArmMatrix K = ArmMatrix::Identity() * 8;
  K(0, 3) = K(3, 0) = 2;
  const HandPoint point = PointAt(arm, q, Vector3::Zero());
  const auto stiffness = EndpointStiffness(K, point);
  ASSERT_TRUE(stiffness);
  const Vector3 shift = Vector3(1, -2, 0.5) * 1e-3;
  Eigen::Matrix<double, 13, 13> A = Eigen::Matrix<double, 13, 13>::Zero();
  A.topLeftCorner<7, 7>() = K;
  A.topRightCorner<7, 6>() = point.J.transpose();
  A.bottomLeftCorner<6, 7>() = point.J;
  Eigen::Matrix<double, 13, 1> b = Eigen::Matrix<double, 13, 1>::Zero();
  b.segment<3>(7) = shift;
  const Eigen::Matrix<double, 13, 1> x = A.partialPivLu().solve(b);
  EXPECT_LT((*stiffness * shift + x.segment<3>(7)).norm(), 1e-9);
}

TEST(Stiffness, IsEmptyIfThePostureIsNotStable) {
  const ArmModel arm({}, 1);
  const ArmVector q = WorkPosture();
  EXPECT_FALSE(EndpointStiffness(-ArmMatrix::Identity(), PointAt(arm, q, Vector3::Zero())));
  // If the push acts along the arm, the arm buckles.
  EXPECT_FALSE(
      EndpointStiffness(0.1 * ArmMatrix::Identity(), PointAt(arm, q, Vector3(-500, 0, 0))));
}

}  // namespace
}  // namespace predictor::muscles
