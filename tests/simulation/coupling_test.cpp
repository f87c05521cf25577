#include "simulation/coupling.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

constexpr double kStep = 0.001;       // [s]
constexpr double kSpeedCap = 0.25;    // [m/s]
constexpr double kRotationCap = 1.5;  // [rad/s]
const HandleMobility kHeavy = {0.05, 1};

Coupling Make(const CouplingSpec& spec = {}, const HandleMobility& mobility = kHeavy) {
  return Coupling(spec, kSpeedCap, kRotationCap, mobility, kStep);
}

FrameMotion At(const Vector3& p, const Vector3& w = Vector3::Zero()) {
  FrameMotion motion;
  motion.X_W = {p, RotationFromVector(w)};
  return motion;
}

TEST(Coupling, IsZeroInNormalRunning) {
  const CouplingSpec spec;
  FrameMotion D = At({0.5, 0.1, 0.3});
  FrameMotion H =
      At({0.5, 0.1, 0.3 - 0.99 * spec.deadband}, Vector3(0.9 * spec.rotation_deadband, 0, 0));
  D.V_W << 0.2, 0.1, -0.1, 0.5, -1, 0.5;
  H.V_W << -0.2, 0.1, 0, 0, 0, 0;
  EXPECT_TRUE(Make().Compute(D, H).isZero(0));
}

TEST(Coupling, IsASpringBeyondTheDeadband) {
  const CouplingSpec spec;
  const Vector3 direction = Vector3(1, -2, 2) / 3;
  const FrameMotion D = At({0, 0, 0});
  const FrameMotion H = At(0.01 * direction, 0.2 * direction);
  const Wrench F = Make().Compute(D, H);
  EXPECT_LT((F.head<3>() - spec.stiffness * (0.01 - spec.deadband) * direction).norm(), 1e-9);
  EXPECT_LT(
      (F.tail<3>() - spec.rotation_stiffness * (0.2 - spec.rotation_deadband) * direction).norm(),
      1e-9);
}

TEST(Coupling, DampsTheRelativeMotionFullyAtTwiceTheDeadband) {
  const CouplingSpec spec;
  FrameMotion D = At({0, 0, 0});
  FrameMotion H = At({2 * spec.deadband, 0, 0});
  const Wrench still = Make().Compute(D, H);
  D.V_W.head<3>() = Vector3(0.05, 0.02, 0);
  H.V_W.head<3>() = Vector3(-0.01, 0, 0.1);
  const Vector3 damping = (Make().Compute(D, H) - still).head<3>();
  EXPECT_LT((damping - spec.damping * (H.V_W - D.V_W).head<3>()).norm(), 1e-9);
}

// At the edge of the deadband and at the speed cap, the force must be continuous for any
// velocities.
TEST(Coupling, IsContinuous) {
  const CouplingSpec spec;
  const double tiny = 1e-9;
  FrameMotion D = At({0, 0, 0});
  D.V_W << 0.2, 0.1, 0, 1, 0, 0;
  FrameMotion H = At({spec.deadband + tiny, 0, 0}, {0, spec.rotation_deadband + tiny, 0});
  H.V_W << -0.3, 0, 0, 0, 0, 0;
  EXPECT_LT(Make().Compute(D, H).norm(), 1e-4);
  H = At({0, 0, 0});
  D.V_W << kSpeedCap + tiny, 0, 0, 0, kRotationCap + tiny, 0;
  EXPECT_LT(Make().Compute(D, H).norm(), 1e-5);
  EXPECT_GT(Make().Compute(D, H).norm(), 0);
}

TEST(Coupling, BrakesOnlyTheSpeedAboveTheCap) {
  CouplingSpec spec;
  spec.speed_damping = 600;
  FrameMotion D = At({0, 0, 0});
  D.V_W << 0, 0, -0.4, 0, 2.0, 0;
  const Wrench F = Make(spec).Compute(D, At({0, 0, 0}));
  EXPECT_LT((F.head<3>() - Vector3(0, 0, 600 * (0.4 - kSpeedCap))).norm(), 1e-9);
  EXPECT_LT((F.tail<3>() - Vector3(0, -600 * 0.04 * (2.0 - kRotationCap), 0)).norm(), 1e-9);
}

// Both dampers act at the same time, at their limit for a very light object. One explicit step must
// reduce the relative speed without reversing it.
TEST(Coupling, StaysStableForALightObject) {
  const double mass = 0.01;
  const HandleMobility light = {1 / mass, 1 / 1e-5};
  FrameMotion D = At({0, 0, 0});
  const FrameMotion H = At({0.02, 0, 0}, {0.2, 0, 0});
  const Wrench still = Make({}, light).Compute(D, H);
  double v = -5;
  double w = -50;
  for (int i = 0; i < 5; ++i) {
    D.V_W << v, 0, 0, w, 0, 0;
    const Wrench F = Make({}, light).Compute(D, H) - still;
    EXPECT_LE(std::abs(F[0]) * kStep / mass, 0.6 * std::abs(v) * (1 + 1e-12));
    EXPECT_LE(std::abs(F[3]) * kStep / 1e-5, 0.6 * std::abs(w) * (1 + 1e-12));
    v += F[0] * kStep / mass;
    w += F[3] * kStep / 1e-5;
  }
  EXPECT_LT(v, 0);
  EXPECT_GT(v, -1.5);
}

// Compares the mobility with the accelerations of a free rigid body under unit forces in many
// directions.
TEST(Coupling, MobilityIsTheLargestResponseOfAFreeBody) {
  const double mass = 3;
  Matrix3 inertia = Vector3(0.02, 0.05, 0.06).asDiagonal();
  const Matrix3 R = RotationFromVector({0.3, -0.5, 0.8}).toRotationMatrix();
  inertia = R * inertia * R.transpose();
  const Vector3 lever(0.1, -0.2, 0.05);
  const HandleMobility mobility = MobilityAt(mass, inertia, lever);
  double largest = 0;
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 100; ++j) {
      const double a = M_PI * i / 100, b = M_PI * j / 100;
      const Vector3 n(std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b));
      const Vector3 alpha = inertia.inverse() * lever.cross(n);
      largest = std::max(largest, n.dot(n / mass + alpha.cross(lever)));
    }
  }
  EXPECT_NEAR(mobility.translation, largest, 1e-3 * largest);
  EXPECT_NEAR(mobility.rotation, 1 / 0.02, 1e-9);
}

}  // namespace
}  // namespace predictor
