// Tests the common stop of both arms.
#include "safety/stop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/random.h"
#include "safety/between.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor {
namespace {

using Arms = std::array<JointVector, kHands>;

// Returns handles with constant orientation.
std::array<Pose, kHands> At(const Vector3& left, const Vector3& right = Vector3::Zero()) {
  return {Pose{left, Quaternion::Identity()}, Pose{right, Quaternion::Identity()}};
}

JointBounds Bounds(int joints, double acceleration, double velocity = 5) {
  return {JointVector::Constant(joints, -100), JointVector::Constant(joints, 100),
          JointVector::Constant(joints, velocity), JointVector::Constant(joints, acceleration)};
}

const Status kForceStop = {StopCause::kForce, 1, 31.5, 30};

// If the guard has passed a command, it must not need to correct a stop that begins from it.
TEST(StopController, ScalesBothArmsByOneFactorWithinEveryJointsBoundsSoak) {
  for (long seed = 1; seed <= Count(500, 50000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "controller");
    const std::array<JointBounds, kHands> bounds = {
        Bounds(7, Between(&random, 2, 20), Between(&random, 0.9, 1.3)),
        Bounds(6, Between(&random, 2, 20), Between(&random, 0.9, 1.3))};
    Guard guard(bounds, kDt);
    const Arms q = {JointVector::Zero(7), JointVector::Zero(6)};
    Arms speed = {JointVector(7), JointVector(6)};
    for (JointVector& arm : speed) {
      for (double& x : arm) x = Between(&random, -1, 1);
    }
    Arms v;
    for (int k = 0; k < 1000; ++k) {
      v = speed;
      guard.Apply(q, &v);
    }
    const Arms begun = guard.last();  // some joints are at their velocity bounds
    StopController stop(SafetySpec{}, bounds, kDt);
    stop.Begin(kForceStop, 2.5, begun, Between(&random, 0, 0.25), Between(&random, -5, 5));
    int ticks = 0;
    for (; !stop.commands_rest(); ++ticks) {
      ASSERT_LT(ticks, 5000);
      stop.Next(&v);
      const double factor = v[0][0] / begun[0][0];
      ASSERT_GE(factor, 0);
      ASSERT_LE(factor, StopProfile::kOvershoot + 1e-12);
      for (std::size_t arm = 0; arm < kHands; ++arm) {
        ASSERT_LE((v[arm] - factor * begun[arm]).cwiseAbs().maxCoeff(), 1e-12);
      }
      ASSERT_EQ(guard.Apply(q, &v), 0) << seed << " tick " << ticks;
    }
    for (const JointVector& arm : guard.last()) ASSERT_TRUE((arm.array() == 0).all());
  }
}

// After missed deadlines, the next command must be the one that the stop would have reached
// meanwhile, and the guard must permit the larger deceleration.
TEST(StopController, KeepsItsTimeWhenDeadlinesAreMissed) {
  const std::array<JointBounds, kHands> bounds = {Bounds(1, 10), Bounds(1, 10)};
  const Arms q = {JointVector::Zero(1), JointVector::Zero(1)};
  for (const int passed : {2, 4}) {
    StopController each(SafetySpec{}, bounds, kDt), some(SafetySpec{}, bounds, kDt);
    Guard guard(bounds, kDt);
    Arms now = {JointVector::Constant(1, 0.5), JointVector::Constant(1, -0.4)}, late = now;
    const Arms begun = now;
    for (int k = 0; k < 100; ++k) guard.Apply(q, &(now = begun));
    each.Begin(kForceStop, 0, begun, 0.25, 0);
    some.Begin(kForceStop, 0, begun, 0.25, 0);
    while (!each.commands_rest()) {
      for (int k = 0; k < passed; ++k) each.Next(&now);
      some.Next(&late, passed);
      ASSERT_EQ(late, now);
      ASSERT_EQ(guard.Apply(q, &late, passed), 0);
    }
    EXPECT_TRUE(some.commands_rest());
  }
}

// If the geometry becomes unreliable, the stop must keep the correction made so far, so that the
// command does not jump.
TEST(StopController, ContinuesUnchangedOnceTheGeometryIsInDoubt) {
  const std::array<JointBounds, kHands> bounds = {Bounds(2, 10), JointBounds{}};
  StopController stop(SafetySpec{}, bounds, kDt);
  Arms v = {JointVector::Constant(2, 0.5), JointVector()};
  stop.Begin(kForceStop, 0, v, 0.25, 0);
  StopGeometry geometry;
  geometry.J[0] = Jacobian::Zero(6, 2);
  geometry.J[0](0, 0) = geometry.J[0](1, 1) = 0.5;
  stop.Next(geometry, &v);
  geometry.J[0](0, 0) = 0.6;  // the first joint now moves the handle more
  for (int k = 0; k < 20; ++k) stop.Next(geometry, &v);
  const double corrected = v[0][0] / v[0][1];
  ASSERT_LT(corrected, 0.9);
  for (int k = 0; k < 10; ++k) {
    stop.Next(&v);
    EXPECT_NEAR(v[0][0] / v[0][1], corrected, 1e-9);
  }
}

// Two links of 0.4 m in a plane, whose kinematics are written only for this test.
struct PlanarArm {
  double base_x, q1, q2;
  Vector3 Handle() const {
    return {base_x + 0.4 * (std::cos(q1) + std::cos(q1 + q2)),
            0.4 * (std::sin(q1) + std::sin(q1 + q2)), 0};
  }
  JointVector VelocityFor(double vx, double vy) const {
    const double s1 = 0.4 * std::sin(q1), c1 = 0.4 * std::cos(q1);
    const double s12 = 0.4 * std::sin(q1 + q2), c12 = 0.4 * std::cos(q1 + q2);
    Eigen::Matrix2d J;
    J << -s1 - s12, -s12, c1 + c12, c12;
    const Eigen::Vector2d v = J.inverse() * Eigen::Vector2d(vx, vy);
    JointVector result(2);
    result << v[0], v[1];
    return result;
  }
};

struct PlanarStop {
  StopReport report;
  double drift = 0;      // change of the handles' distance [m]
  double travelled = 0;  // path of the faster handle [m]
};

// Stops two arms in different postures that hold one object at `speed`. The joints of both arms
// follow the command with a first-order lag.
PlanarStop RunPlanarStop(double speed, double lag) {
  std::array<PlanarArm, kHands> arms = {PlanarArm{-0.3, 2.2, -1.4}, PlanarArm{0.3, 0.6, 1.5}};
  const std::array<JointBounds, kHands> bounds = {Bounds(2, 40), Bounds(2, 40)};
  StopController stop(SafetySpec{}, bounds, kDt);
  const Arms last = {arms[0].VelocityFor(0.6 * speed, 0.8 * speed),
                     arms[1].VelocityFor(0.6 * speed, 0.8 * speed)};
  Arms v = last, command = last;
  const Vector3 apart = arms[1].Handle() - arms[0].Handle();
  stop.Begin(kForceStop, 1.25, last, speed, 0);
  stop.Observe(At(arms[0].Handle(), arms[1].Handle()));
  PlanarStop result;
  std::array<double, kHands> path = {};
  for (int k = 0; k < 2000 && !stop.done(); ++k) {
    stop.Next(&command);
    for (std::size_t i = 0; i < kHands; ++i) {
      const Vector3 before = arms[i].Handle();
      v[i] += (1 - std::exp(-kDt / lag)) * (command[i] - v[i]);
      arms[i].q1 += v[i][0] * kDt;
      arms[i].q2 += v[i][1] * kDt;
      path[i] += (arms[i].Handle() - before).norm();
    }
    stop.Observe(At(arms[0].Handle(), arms[1].Handle()));
  }
  result.report = stop.report();
  result.drift = (arms[1].Handle() - arms[0].Handle() - apart).norm();
  result.travelled = std::max(path[0], path[1]);
  EXPECT_TRUE(stop.done());
  return result;
}

// The common factor preserves the relative pose to first order. Over a stopping distance d, the
// curvatures of the arms' paths move the handles apart by about d²/2 (1/r + 1/r').
TEST(StopController, HandlesKeepTheirRelativePosition) {
  for (const double speed : {0.05, 0.1, 0.25}) {
    const PlanarStop stop = RunPlanarStop(speed, 0.02);
    EXPECT_LE(stop.drift, 0.002);
    EXPECT_LE(stop.drift, 4 * stop.travelled * stop.travelled);
  }
}

TEST(StopController, ReportsCauseTimeAndDuration) {
  const PlanarStop stop = RunPlanarStop(0.25, 0.02);
  EXPECT_EQ(stop.report.status.cause, StopCause::kForce);
  EXPECT_EQ(stop.report.status.hand, 1);
  EXPECT_EQ(stop.report.status.value, 31.5);
  EXPECT_EQ(stop.report.status.limit, 30);
  EXPECT_EQ(stop.report.time, 1.25);
  // From a constant speed of 0.25 m/s, the commands take 70 ms and 8.75 mm. The lag adds a distance
  // of v·20 ms. The lag also adds the time until less than 50 µm of this distance is left.
  EXPECT_NEAR(stop.travelled, 0.00875 + 0.25 * 0.02, 0.0004);
  EXPECT_GE(stop.report.duration, 0.070);
  EXPECT_LE(stop.report.duration, 0.070 + 6 * 0.02);
}

TEST(StopController, LatchesTheFirstCauseUntilReset) {
  const std::array<JointBounds, kHands> bounds = {Bounds(2, 10), JointBounds{}};
  StopController stop(SafetySpec{}, bounds, kDt);
  EXPECT_FALSE(stop.active());
  const Arms moving = {JointVector::Constant(2, 0.3), JointVector()};
  stop.Begin(kForceStop, 1, moving, 0.2, 0);
  Arms v;
  for (int k = 0; k < 30; ++k) stop.Next(&v);
  const double before = v[0][0];
  stop.Begin({StopCause::kOperator, -1, 0, 0}, 2, moving, 0.2, 0);
  stop.Next(&v);
  EXPECT_LT(v[0][0], before);  // the stop does not start again
  EXPECT_EQ(stop.report().status.cause, StopCause::kForce);
  EXPECT_EQ(stop.report().time, 1);
  stop.Reset();
  EXPECT_FALSE(stop.active());
  EXPECT_TRUE(stop.report().status.ok());
  stop.Next(&v);
  EXPECT_EQ(v[0].size(), 2);
  EXPECT_EQ(v[1].size(), 0);
  EXPECT_EQ(v[0].norm(), 0);
}

TEST(StopController, JointsThatMoveWhileTheHandlesStandStopWithinTheirOwnBounds) {
  const std::array<JointBounds, kHands> bounds = {Bounds(7, 10), Bounds(7, 10)};
  for (const double speed : {0.0, 1e-7, kNan}) {
    StopController stop(SafetySpec{}, bounds, kDt);
    const Arms moving = {JointVector::Constant(7, 0.5), JointVector::Constant(7, -0.2)};
    stop.Begin(kForceStop, 0, moving, speed, 0);
    Arms v, last = moving;
    int ticks = 0;
    for (; !stop.commands_rest() && ticks < 1000; ++ticks) {
      stop.Next(&v);
      EXPECT_LE((v[0] - last[0]).cwiseAbs().maxCoeff(), 10 * kDt * (1 + 1e-9));
      last = v;
    }
    const double planned = 0.5 / (10 * StopController::kShareOfJoints) / kDt;  // 0.5 rad/s
    EXPECT_GE(ticks, planned);
    EXPECT_LE(ticks, std::isnan(speed) ? 2 * planned : planned + 10);
  }
}

TEST(StopController, AtRestOrWithoutArmsItIsDoneAtOnce) {
  for (const int joints : {0, 6}) {
    const std::array<JointBounds, kHands> bounds = {Bounds(joints, 10), JointBounds{}};
    StopController stop(SafetySpec{}, bounds, kDt);
    const Arms rest = {JointVector::Zero(joints), JointVector()};
    stop.Begin({StopCause::kOperator, -1, 0, 0}, 3, rest, 0.1, 0);
    EXPECT_TRUE(stop.commands_rest());
    for (int k = 0; k < 50; ++k) stop.Observe(At(Vector3(1, 2, 3)));
    EXPECT_TRUE(stop.done());
    EXPECT_EQ(stop.report().duration, 0);
  }
}

// An arm whose command contains a NaN must get zero velocity immediately. The other arm must brake
// as usual.
TEST(StopController, ANanCommandHasNoEffect) {
  StopController stop(SafetySpec{}, {Bounds(2, 10), Bounds(2, 10)}, kDt);
  Arms v = {JointVector::Constant(2, 0.3), JointVector::Constant(2, 0.3)};
  v[0][1] = std::numeric_limits<double>::quiet_NaN();
  stop.Begin(kForceStop, 0, v, 0.2, 0);
  for (int k = 0; !stop.commands_rest(); ++k) {
    ASSERT_LT(k, 500);
    stop.Next(&v);
    ASSERT_TRUE(v[0].size() == 0 || v[0].isZero(0));
    ASSERT_TRUE(v[1].allFinite());
    ASSERT_TRUE(k > 0 || v[1].norm() > 0.2);
  }
}

// The handles keep moving after the arms were commanded to rest. Even then, the stop must end.
TEST(StopController, DoesNotWaitForEver) {
  StopController stop(SafetySpec{}, {Bounds(1, 10), JointBounds{}}, kDt);
  stop.Begin(kForceStop, 0, {JointVector::Zero(1), JointVector()}, 0, 0);
  int ticks = 0;
  for (; !stop.done() && ticks < 10000; ++ticks) {
    stop.Observe(At(Vector3(0.1 * std::sin(0.01 * ticks), 0, 0)));
  }
  EXPECT_NEAR(ticks * kDt, StopController::kPatience, 2 * kDt);
}

// The waiting time must start at the end of the commands, regardless of how long the commands take.
TEST(StopController, IsNotDoneWhileItsCommandsBrake) {
  StopController stop(SafetySpec{}, {Bounds(1, 0.5), JointBounds{}}, kDt);
  Arms v = {JointVector::Constant(1, 0.8), JointVector()};
  stop.Begin(kForceStop, 0, v, 0.2, 0);
  int ticks = 0;
  for (double x = 0; !stop.commands_rest(); ++ticks) {
    ASSERT_LT(ticks, 10000);
    stop.Next(&v);
    stop.Observe(At(Vector3(x += 0.25 * v[0][0] * kDt, 0, 0)));
    ASSERT_FALSE(stop.done()) << ticks;
  }
  EXPECT_GT(ticks * kDt, 2 * StopController::kPatience);
}

// A driver brings its arm to rest on a path that the driver chooses, in steps that are not visible
// at the handle.
TEST(StopController, AnArmThatIsBroughtToRestDoesNotRestYet) {
  const std::array<Pose, kHands> still;
  StopController stop(SafetySpec{}, {Bounds(1, 10), JointBounds{}}, kDt);
  const auto begin = [&] {
    stop.Reset();
    stop.Begin(kForceStop, 0, {JointVector::Zero(1), JointVector()}, 0, 0);
  };
  begin();
  for (int k = 0; k < 100; ++k) stop.Observe(still, true);
  EXPECT_FALSE(stop.done());
  int ticks = 0;
  for (; !stop.done() && ticks < 1000; ++ticks) stop.Observe(still, false);
  EXPECT_NEAR(ticks * kDt, StopController::kRestTime, 2 * kDt);
  EXPECT_FALSE(stop.timed_out());
  begin();
  for (ticks = 0; !stop.done() && ticks < 10000; ++ticks) stop.Observe(still, true);
  EXPECT_NEAR(ticks * kDt, StopController::kPatience, 2 * kDt);
  EXPECT_TRUE(stop.timed_out());
}

// A rotation about the handle's own axis moves no point on that axis.
TEST(StopController, AHandleThatTurnsOnDoesNotRest) {
  for (const double speed : {0.02, 0.03}) {  // [rad/s]; 2.5 mm/s at a tenth of a metre is 0.025
    StopController stop(SafetySpec{}, {Bounds(1, 10), JointBounds{}}, kDt);
    stop.Begin(kForceStop, 0, {JointVector::Zero(1), JointVector()}, 0, 0);
    std::array<Pose, kHands> X;
    int ticks = 0;
    for (; !stop.done() && ticks < 10000; ++ticks) {
      X[1].q = Quaternion(Eigen::AngleAxisd(speed * ticks * kDt, Vector3::UnitX()));
      stop.Observe(X);
    }
    const bool rests = speed < 0.025;
    EXPECT_EQ(stop.timed_out(), !rests) << speed;
    EXPECT_NEAR(ticks * kDt, rests ? StopController::kRestTime : StopController::kPatience,
                2 * kDt);
  }
}

TEST(StopController, EncoderNoiseIsNotMotion) {
  StopController stop(SafetySpec{}, {Bounds(1, 10), JointBounds{}}, kDt);
  stop.Begin(kForceStop, 0, {JointVector::Zero(1), JointVector()}, 0, 0);
  RandomStream random(1, "encoder");
  for (int k = 0; k < 1000 && !stop.done(); ++k) {
    stop.Observe(At(Vector3(1e-5 * random.Uniform(), 1e-5 * random.Uniform(), 0)));
  }
  EXPECT_TRUE(stop.done());
  EXPECT_FALSE(stop.timed_out());
}

}  // namespace
}  // namespace predictor
