#include "simulation/controllers/set_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace predictor {
namespace {

const Pose kStart = PoseFromXyzRpy({0.4, -0.1, 0.5}, {0.4, -0.2, 1.0});

std::vector<Waypoint> TwoWaypoints() {
  return {{2.0, {0.1, 0.2, -0.1}, {0.3, 0, 0}}, {5.0, {0.1, -0.3, 0}, {0, -0.4, 0.9}}};
}

TEST(SetPoint, StaysAtTheStartWithoutWaypoints) {
  const SetPointTrajectory trajectory({}, kStart);
  const FrameMotion motion = trajectory.At(3);
  EXPECT_EQ(motion.X_W.p, kStart.p);
  EXPECT_TRUE(motion.V_W.isZero(0));
  EXPECT_TRUE(motion.A_W.isZero(0));
}

TEST(SetPoint, PassesTheWaypointsAtRest) {
  const SetPointTrajectory trajectory(TwoWaypoints(), kStart);
  for (const Waypoint& w : TwoWaypoints()) {
    const FrameMotion motion = trajectory.At(w.time);
    EXPECT_LT((motion.X_W.p - kStart.p - w.xyz).norm(), 1e-12);
    const Quaternion expected = PoseFromXyzRpy({0, 0, 0}, w.rpy).q * kStart.q;
    EXPECT_LT(RotationError(expected, motion.X_W.q).norm(), 1e-9);
    EXPECT_LT(motion.V_W.norm(), 1e-12);
    EXPECT_LT(motion.A_W.norm(), 1e-12);
  }
  EXPECT_LT((trajectory.At(0).X_W.p - kStart.p).norm(), 1e-15);
  EXPECT_LT((trajectory.At(99).X_W.p - trajectory.At(5).X_W.p).norm(), 1e-15);
}

TEST(SetPoint, TwistAndAccelerationAreDerivatives) {
  const SetPointTrajectory trajectory(TwoWaypoints(), kStart);
  const double h = 1e-5;
  for (const double t : {0.3, 1.1, 1.9, 2.4, 3.5, 4.8}) {
    const FrameMotion before = trajectory.At(t - h);
    const FrameMotion after = trajectory.At(t + h);
    const FrameMotion now = trajectory.At(t);
    EXPECT_LT((PoseError(after.X_W, before.X_W) / (2 * h) - now.V_W).norm(), 1e-8);
    EXPECT_LT(((after.V_W - before.V_W) / (2 * h) - now.A_W).norm(), 1e-8);
  }
}

// The integral of the twist, by Simpson's rule.
TEST(SetPoint, PathIsTheIntegralOfTheTwist) {
  const SetPointTrajectory trajectory(TwoWaypoints(), kStart);
  EXPECT_TRUE(trajectory.PathAt(0).isZero(0));
  const double h = 1e-3;
  Vector6 sum = Vector6::Zero();
  for (int k = 0; k < 6000; ++k) {
    const double t = h * k;
    sum += h / 6 *
           (trajectory.At(t).V_W + 4 * trajectory.At(t + h / 2).V_W + trajectory.At(t + h).V_W);
    ASSERT_LT((trajectory.PathAt(t + h) - sum).norm(), 1e-9) << t;
    Vector6 path = Vector6::Constant(NAN);
    trajectory.At(t, &path);
    ASSERT_EQ(path, trajectory.PathAt(t)) << t;
  }
}

// The peak speed of a minimum-jerk motion is 1.875 L/T (Flash & Hogan 1985).
TEST(SetPoint, PeakSpeedIsThatOfMinimumJerk) {
  const SetPointTrajectory trajectory({{4.0, {0.3, 0, 0}, {0, 0, 0}}}, kStart);
  EXPECT_NEAR(trajectory.At(2).V_W[0], 1.875 * 0.3 / 4, 1e-12);
}

TEST(SetPoint, RefusesTimesThatDoNotIncrease) {
  EXPECT_THROW(SetPointTrajectory({{0.0, {0, 0, 0}, {0, 0, 0}}}, kStart), InputError);
  EXPECT_THROW(
      SetPointTrajectory({{2.0, {0, 0, 0}, {0, 0, 0}}, {1.0, {0, 0, 0}, {0, 0, 0}}}, kStart),
      InputError);
}

}  // namespace
}  // namespace predictor
