// Compares the kinematics with finite differences. Only FramePose is differentiated.
#include <gtest/gtest.h>

#include "models/robots.h"
#include "support/allocation_guard.h"

namespace predictor::test {
namespace {

constexpr int kStates = 50;
constexpr double kStep = 1e-5;       // [rad] or [m]: error of central differences ~ kStep²
constexpr double kTolerance = 1e-8;  // of first derivatives of order 1

class Kinematics : public RobotTest {
 protected:
  Pose PoseAt(const JointVector& at) {
    data.UpdateKinematics(*model, at, v);
    return data.FramePose(*model, frame);
  }
  Jacobian JacobianAt(const JointVector& at) {
    data.UpdateKinematics(*model, at, v);
    Jacobian J;
    data.FrameJacobian(*model, frame, &J);
    return J;
  }
};

INSTANTIATE_TEST_SUITE_P(Robots, Kinematics, testing::ValuesIn(RobotCases()), NameOf);

TEST_P(Kinematics, LoadsTheJointsThatWereExpected) { EXPECT_EQ(n, GetParam().dof); }

TEST_P(Kinematics, JacobianIsTheDerivativeOfThePose) {
  for (int i = 0; i < kStates; ++i, Shake()) {
    const Jacobian J = JacobianAt(q);
    for (int j = 0; j < n; ++j) {
      const Vector6 difference =
          PoseError(PoseAt(q + kStep * Unit(j)), PoseAt(q - kStep * Unit(j))) / (2 * kStep);
      EXPECT_LT((J.col(j) - difference).norm(), kTolerance) << "joint " << j;
    }
  }
}

TEST_P(Kinematics, TwistIsTheDerivativeOfThePose) {
  for (int i = 0; i < kStates; ++i, Shake()) {
    const Vector6 difference =
        PoseError(PoseAt(q + kStep * v), PoseAt(q - kStep * v)) / (2 * kStep);
    data.UpdateKinematics(*model, q, v);
    EXPECT_LT((data.FrameTwist(*model, frame) - difference).norm(), 100 * kTolerance);
    EXPECT_LT((data.FrameTwist(*model, frame) - JacobianAt(q) * v).norm(), 1e-12);
  }
}

TEST_P(Kinematics, MotionIsTheDerivativeOfPoseAndTwist) {
  for (int i = 0; i < kStates; ++i, Shake()) {
    const JointVector a = RandomVector(5);
    const auto twist_at = [&](double t) -> Vector6 {
      return JacobianAt(q + t * v + t * t / 2 * a) * (v + t * a);
    };
    const Vector6 difference = (twist_at(kStep) - twist_at(-kStep)) / (2 * kStep);
    data.UpdateKinematics(*model, q, v);
    const FrameMotion motion = data.MotionOf(*model, frame, a);
    EXPECT_LT((motion.A_W - difference).norm(), 1e-7 * (1 + difference.norm()));
    EXPECT_LT((motion.V_W - JacobianAt(q) * v).norm(), 1e-12);
    EXPECT_LT(PoseError(motion.X_W, PoseAt(q)).norm(), 1e-12);
  }
}

TEST_P(Kinematics, HessianIsTheDerivativeOfTheJacobian) {
  for (int i = 0; i < kStates; ++i, Shake()) {
    std::vector<Jacobian> H;
    KinematicHessian(JacobianAt(q), &H);
    ASSERT_EQ(static_cast<int>(H.size()), n);
    for (int j = 0; j < n; ++j) {
      const Jacobian difference =
          (JacobianAt(q + kStep * Unit(j)) - JacobianAt(q - kStep * Unit(j))) / (2 * kStep);
      EXPECT_LT((H[static_cast<std::size_t>(j)] - difference).norm(), 10 * kTolerance);
    }
  }
}

TEST_P(Kinematics, ManipulabilityAndItsGradientByDifferences) {
  const auto manipulability = [this](const JointVector& at) {
    const Eigen::Matrix3Xd J = JacobianAt(at).topRows<3>();
    return J.jacobiSvd().singularValues().prod();
  };
  for (int i = 0; i < kStates; ++i, Shake()) {
    double m = 0;
    JointVector gradient;
    data.UpdateKinematics(*model, q, v);
    data.ManipulabilityGradient(*model, frame, &m, &gradient);
    EXPECT_NEAR(m, manipulability(q), 1e-10);
    if (m < 1e-3) continue;  // the curvature of the square root is too large for differences
    for (int j = 0; j < n; ++j) {
      const double difference =
          (manipulability(q + kStep * Unit(j)) - manipulability(q - kStep * Unit(j))) / (2 * kStep);
      EXPECT_NEAR(gradient(j), difference, 1e-6);
    }
  }
}

TEST_P(Kinematics, FramesOfTheBaseStandStill) {
  const Pose X_LF = PoseFromXyzRpy({0.1, 0.2, 0.3}, {0, 0, 1});
  const std::string& root = urdf.links[static_cast<std::size_t>(urdf.root)].name;
  frame = model->Frame(root, X_LF);
  EXPECT_LT(PoseError(PoseAt(q), SlantedBase() * X_LF).norm(), 1e-12);
  EXPECT_EQ(JacobianAt(q).norm(), 0);
  EXPECT_EQ(data.FrameTwist(*model, frame).norm(), 0);
  EXPECT_EQ(data.MotionOf(*model, frame, v).V_W.norm(), 0);
  EXPECT_EQ(data.MotionOf(*model, frame, v).A_W.norm(), 0);
  double m = 1;
  JointVector gradient;
  data.ManipulabilityGradient(*model, frame, &m, &gradient);
  EXPECT_EQ(m, 0);
  EXPECT_EQ(gradient, JointVector::Zero(n));
}

TEST_P(Kinematics, NothingAllocatesAfterConstruction) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Jacobian J;
  double m = 0, sum = 0;
  JointVector gradient;
  const AllocationGuard guard;
  for (int i = 0; i < kStates; ++i, Shake()) {
    data.UpdateKinematics(*model, q, v);
    data.FrameJacobian(*model, frame, &J);
    sum += data.FramePose(*model, frame).p.x() + data.FrameTwist(*model, frame)(0) +
           data.MotionOf(*model, frame, v).A_W(0);
    data.ManipulabilityGradient(*model, frame, &m, &gradient);
    data.UpdateDynamics(*model, q, v, 9.81);
    sum += data.M()(0, 0) + data.bias()(0) + data.gravity()(0);
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(AllocationGuard, CountsAllocations) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  const AllocationGuard guard;
  std::vector<double> numbers(10);
  EXPECT_EQ(guard.count(), 1);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<int>(numbers.size()));
  EXPECT_EQ(guard.count(), 2);
  x.resize(0);
  EXPECT_EQ(guard.count(), 3);
}

}  // namespace
}  // namespace predictor::test
