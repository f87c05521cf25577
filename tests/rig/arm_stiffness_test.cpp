#include "rig/arm_stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "core/random.h"

namespace predictor {
namespace {

// Computes the positions of an arm whose joints are rotated by q from the given points. The
// computation does not use the functions under test.
struct TurnedArm {
  ArmPoints at_zero;
  Vector3 lateral, normal;

  Vector3 Hand(const Vector3& q) const {
    const Eigen::AngleAxisd base(q[0], lateral), shoulder(q[1], normal), elbow(q[2], normal);
    const Vector3 upper = at_zero.elbow - at_zero.shoulder, fore = at_zero.hand - at_zero.elbow;
    return at_zero.shoulder + base * (shoulder * (upper + elbow * fore));
  }
  Matrix3 Jacobian(const Vector3& q) const {
    constexpr double h = 1e-5;
    Matrix3 J;
    for (int i = 0; i < 3; ++i) {
      const Vector3 dq = h * Vector3::Unit(i);
      J.col(i) = (Hand(q + dq) - Hand(q - dq)) / (2 * h);
    }
    return J;
  }
};

// Returns the force that holds the hand at q. The torques of the muscles are the torques that
// balance F0 at q = 0, minus K q.
Vector3 HoldingForce(const TurnedArm& arm, const Matrix3& K, const Vector3& F0, const Vector3& q) {
  const Vector3 torque = -arm.Jacobian(Vector3::Zero()).transpose() * F0 - K * q;
  return -arm.Jacobian(q).transpose().inverse() * torque;
}

ArmPoints BentArm(double elbow) {
  const Vector3 shoulder(0.1, 0.2, 1.4), upper(0.05, 0.02, -0.29);
  const Vector3 fore = Eigen::AngleAxisd(-elbow, Vector3(0.2, 1, 0.1).normalized()) * upper;
  return {shoulder, shoulder + upper, shoulder + upper + 1.1 * fore};
}

TEST(ArmStiffness, IsTheDerivativeOfTheForceThatHoldsTheHand) {
  RandomStream random(1, "arm");
  for (int k = 0; k < 20; ++k) {
    const ArmPoints points = BentArm(0.9 + random.Uniform());
    const ArmAxes axes = AxesOf(points);
    const TurnedArm arm = {points, axes.lateral, axes.normal};
    EXPECT_LT((HandJacobian(points, axes) - arm.Jacobian(Vector3::Zero())).norm(), 1e-8);
    const Vector3 F = 10 * Vector3(random.Normal(), random.Normal(), random.Normal());
    const Matrix3 K =
        JointStiffness(5 * Vector3(random.Normal(), random.Normal(), random.Normal()));
    Matrix3 slope;  // dF/dq
    constexpr double h = 1e-3;
    for (int i = 0; i < 3; ++i) {
      const Vector3 dq = h * Vector3::Unit(i);
      slope.col(i) = (HoldingForce(arm, K, F, dq) - HoldingForce(arm, K, F, -dq)) / (2 * h);
    }
    const Matrix3 expected = slope * arm.Jacobian(Vector3::Zero()).inverse();
    const Vector3 values = Eigen::SelfAdjointEigenSolver<Matrix3>(expected).eigenvalues();
    if (values[0] < kMinHandStiffness || values[2] > kMaxHandStiffness) continue;
    const Matrix3 actual = HandStiffness(points, K, F);
    EXPECT_LT((actual - expected).norm(), 2e-3 * expected.norm()) << k;
  }
}

// Mussa-Ivaldi, Hogan & Bizzi 1985 found that the relaxed hand is stiffest roughly towards the
// shoulder. The farther the hand is from the shoulder, the less stiff it is.
TEST(ArmStiffness, HasTheShapeThatIsMeasuredInPeople) {
  double softest_before = kMaxHandStiffness;
  for (const double elbow : {1.9, 1.5, 1.1}) {
    const Vector3 s(0, 0, 0), e(0, 0.30, 0);
    const Vector3 h = e + 0.33 * Vector3(std::sin(elbow), std::cos(elbow), 0);
    const Matrix3 K = HandStiffness({s, e, h}, JointStiffness(Vector3::Zero()), Vector3::Zero());
    const Eigen::SelfAdjointEigenSolver<Matrix3> solver(K);
    const double angle = std::acos(std::abs(solver.eigenvectors().col(2).dot(h.normalized())));
    EXPECT_LT(angle, 35 * std::numbers::pi / 180) << elbow;
    EXPECT_GT(solver.eigenvalues()[2], 100);
    EXPECT_LT(solver.eigenvalues()[2], 600);
    EXPECT_LT(solver.eigenvalues()[0], softest_before + 1e-9);
    softest_before = solver.eigenvalues()[0];
  }
}

TEST(ArmStiffness, MirrorsWithTheArm) {
  const Vector3 mirror(1, -1, 1);
  const ArmPoints arm = BentArm(1.2);
  const ArmPoints other = {arm.shoulder.cwiseProduct(mirror), arm.elbow.cwiseProduct(mirror),
                           arm.hand.cwiseProduct(mirror)};
  const Matrix3 KJ = JointStiffness({1, 4, 3});
  const Vector3 F(3, 8, -5);
  const Matrix3 M = mirror.asDiagonal();
  const Matrix3 K = HandStiffness(other, KJ, F.cwiseProduct(mirror));
  EXPECT_LT((M * HandStiffness(arm, KJ, F) * M - K).norm(), 1e-6);
}

TEST(ArmStiffness, GrowsWithTorque) {
  const ArmPoints arm = BentArm(1.2);
  const double relaxed =
      HandStiffness(arm, JointStiffness(Vector3::Zero()), Vector3::Zero()).trace();
  EXPECT_GT(HandStiffness(arm, JointStiffness({3, 3, 3}), Vector3::Zero()).trace(), relaxed);
}

TEST(ArmStiffness, OfAStraightArmIsFinite) {
  const ArmPoints arm = {{0, 0, 1}, {0.3, 0, 1}, {0.6, 0, 1}};
  const Matrix3 K = HandStiffness(arm, JointStiffness(Vector3::Zero()), Vector3::Zero());
  EXPECT_NEAR(K(0, 0), kMaxHandStiffness, 1e-6);
  EXPECT_GE(K(1, 1), kMinHandStiffness - 1e-6);
}

TEST(ArmStiffness, DampingHasTheRatioAlongEachPrincipalDirection) {
  const Matrix3 K = HandStiffness(BentArm(1.2), JointStiffness({1, 4, 3}), Vector3(3, 8, -5));
  const double mass = 1.5, ratio = 0.3;
  const Matrix3 D = HandDamping(K, mass, ratio);
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(K);
  for (int i = 0; i < 3; ++i) {
    const Vector3 v = solver.eigenvectors().col(i);
    EXPECT_LT((D * v - 2 * ratio * std::sqrt(mass * solver.eigenvalues()[i]) * v).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace predictor
