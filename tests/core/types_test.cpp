#include "core/types.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace predictor {
namespace {

Pose RandomPose(RandomStream* r) {
  Pose X;
  X.p = Vector3(r->Normal(), r->Normal(), r->Normal());
  X.q = RotationFromVector(Vector3(r->Normal(), r->Normal(), r->Normal()));
  return X;
}

TEST(Pose, ProductsAndInverseAgreeWithHomogeneousMatrices) {
  RandomStream random(1, "pose");
  const auto matrix = [](const Pose& X) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = X.R();
    m.topRightCorner<3, 1>() = X.p;
    return m;
  };
  for (int i = 0; i < 100; ++i) {
    const Pose A = RandomPose(&random);
    const Pose B = RandomPose(&random);
    EXPECT_LT((matrix(A * B) - matrix(A) * matrix(B)).norm(), 1e-13);
    EXPECT_LT((matrix(A.Inverse()) - matrix(A).inverse()).norm(), 1e-13);
  }
}

TEST(Pose, RollPitchYawTurnAboutFixedAxes) {
  // A roll by 90° turns y into z. A yaw by 90° then leaves this z unchanged and turns x into y.
  const Pose X = PoseFromXyzRpy(Vector3::Zero(), Vector3(M_PI / 2, 0, M_PI / 2));
  EXPECT_LT((X * Vector3(0, 1, 0) - Vector3(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((X * Vector3(1, 0, 0) - Vector3(0, 1, 0)).norm(), 1e-15);
}

TEST(RotationError, IsTheRotationVectorOnTheNearerHemisphere) {
  RandomStream random(2, "rotation");
  for (int i = 0; i < 200; ++i) {
    const Quaternion from = RandomPose(&random).q;
    Vector3 w(random.Normal(), random.Normal(), random.Normal());
    w *= random.Uniform() * 3.1 / w.norm();
    Quaternion to = RotationFromVector(w) * from;
    if (i % 2) to.coeffs() = -to.coeffs();  // the same rotation
    EXPECT_LT((RotationError(to, from) - w).norm(), 1e-9);
  }
}

TEST(RotationError, IsAccurateForTinyAngles) {
  for (const double angle : {1e-3, 1e-6, 1e-10, 1e-14, 0.0}) {
    const Vector3 w(0, angle, 0);
    EXPECT_LT((RotationError(RotationFromVector(w), Quaternion::Identity()) - w).norm(), 1e-15);
  }
}

TEST(RpyOf, IsTheInverseOfPoseFromXyzRpy) {
  RandomStream random(6, "rpy");
  for (int n = 0; n < 200; ++n) {
    const Vector3 rpy(6 * random.Uniform() - 3, 3 * random.Uniform() - 1.5,
                      6 * random.Uniform() - 3);
    const Quaternion q = PoseFromXyzRpy({0, 0, 0}, rpy).q;
    EXPECT_LT((RpyOf(q) - rpy).norm(), 1e-9);
    EXPECT_LT((RpyOf(Quaternion(-q.coeffs())) - rpy).norm(), 1e-9);
  }
  for (const double pitch : {M_PI / 2, -M_PI / 2}) {  // only the sum or difference of roll and yaw
                                                      // is defined
    const Quaternion q = PoseFromXyzRpy({0, 0, 0}, {0.4, pitch, 1.1}).q;
    EXPECT_LT(RotationError(PoseFromXyzRpy({0, 0, 0}, RpyOf(q)).q, q).norm(), 1e-7);
  }
}

TEST(ShiftTwist, AgreesWithFiniteDifferencesOfAFixedPoint) {
  RandomStream random(3, "twist");
  const Pose X_WB = RandomPose(&random);
  const Vector3 p_BC(0.3, -0.2, 0.5);
  Twist V;
  V << 0.1, 0.2, -0.3, 0.4, -0.5, 0.6;
  const double h = 1e-6;
  Pose later = X_WB;
  later.p += h * V.head<3>();
  later.q = RotationFromVector(h * V.tail<3>()) * later.q;
  const Vector3 numeric = (later * p_BC - X_WB * p_BC) / h;
  EXPECT_LT((ShiftTwist(V, X_WB.q * p_BC).head<3>() - numeric).norm(), 1e-6);
}

TEST(ShiftWrench, KeepsPower) {
  RandomStream random(4, "wrench");
  Twist V;
  Wrench F_C;
  for (int k = 0; k < 6; ++k) V[k] = random.Normal(), F_C[k] = random.Normal();
  const Vector3 r(0.2, 0.7, -0.4);
  EXPECT_NEAR(ShiftWrench(F_C, r).dot(V), F_C.dot(ShiftTwist(V, r)), 1e-12);
}

}  // namespace
}  // namespace predictor
