#include "rig/force_sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/constants.h"

namespace predictor {
namespace {

constexpr double kSample = 0.001;  // [s]

SensorSpec Exact() {
  SensorSpec spec;
  spec.noise_force = spec.noise_torque = spec.force_resolution = spec.torque_resolution = 0;
  spec.cutoff_frequency = spec.delay = 0;
  return spec;
}

// Returns a handle whose inertia is neither small nor symmetric.
HandlePayloadSpec Handle() {
  HandlePayloadSpec handle;
  handle.mass = 0.7;
  handle.center_of_mass = {0.02, -0.03, 0.08};
  handle.inertia = {3e-3, 2e-3, 1e-3};
  return handle;
}

Pose PoseAt(double t) {
  const Quaternion q = RotationFromVector({0.5 * std::sin(3 * t), 0.3, -0.4 * std::cos(2 * t)}) *
                       RotationFromVector({0, 1.2 * t, 0.2});
  return {{0.3 * std::sin(2 * t), 0.2 * t * t, 0.1 * std::cos(5 * t)}, q};
}

// Computes the twist by central differences of the pose.
Twist TwistAt(double t) {
  const double h = 1e-5;
  const Pose before = PoseAt(t - h), after = PoseAt(t + h);
  Twist V;
  V << (after.p - before.p) / (2 * h), RotationError(after.q, before.q) / (2 * h);
  return V;
}

FrameMotion MotionAt(double t) {
  const double h = 1e-4;
  return {PoseAt(t), TwistAt(t), (TwistAt(t + h) - TwistAt(t - h)) / (2 * h)};
}

// Computes the linear and angular momentum about the centre of mass, in W.
Vector6 MomentumAt(const HandlePayloadSpec& handle, double t) {
  const Pose X = PoseAt(t);
  const Twist V = ShiftTwist(TwistAt(t), X.q * handle.center_of_mass);
  const Matrix3 I_W = X.R() * handle.inertia.asDiagonal() * X.R().transpose();
  Vector6 momentum;
  momentum << handle.mass * V.head<3>(), I_W * V.tail<3>();
  return momentum;
}

TEST(HandleLoad, AtRestIsTheWeightAtTheCentreOfMass) {
  const HandlePayloadSpec handle = Handle();
  FrameMotion S;
  S.X_W = {{1, 2, 3}, RotationFromVector({0.7, -0.4, 1.1})};
  const Wrench F = HandleLoad(handle, S, 9.81);
  const Vector3 weight(0, 0, -handle.mass * 9.81);
  EXPECT_LT((S.X_W.q * Vector3(F.head<3>()) - weight).norm(), 1e-12);
  const Vector3 arm = S.X_W.q * handle.center_of_mass;
  EXPECT_LT((S.X_W.q * Vector3(F.tail<3>()) - arm.cross(weight)).norm(), 1e-12);
}

TEST(HandleLoad, MovingIsWeightLessRateOfMomentum) {
  const HandlePayloadSpec handle = Handle();
  for (const double t : {0.1, 0.7, 1.3, 2.9}) {
    const double h = 1e-4;
    const Vector6 rate = (MomentumAt(handle, t + h) - MomentumAt(handle, t - h)) / (2 * h);
    Wrench F_C = -rate;
    F_C.z() -= handle.mass * 9.81;
    const FrameMotion S = MotionAt(t);
    const Wrench expected = ShiftWrench(F_C, S.X_W.q * handle.center_of_mass);
    const Wrench F = HandleLoad(handle, S, 9.81);
    EXPECT_LT((S.X_W.q * Vector3(F.head<3>()) - expected.head<3>()).norm(), 1e-5);
    EXPECT_LT((S.X_W.q * Vector3(F.tail<3>()) - expected.tail<3>()).norm(), 1e-6);
  }
}

TEST(ForceSensor, ReadsTheWrenchAfterItsDelayWithItsBias) {
  SensorSpec spec = Exact();
  spec.delay = 0.0035;
  Wrench bias, F;
  bias << 1, 2, 3, 0.1, 0.2, 0.3;
  F << 10, -20, 5, 1, -1, 0.5;
  ForceSensor sensor(spec, bias, kDt, RandomStream(1, "test"));
  for (int k = 0; k < 10; ++k) {
    sensor.Step(F);
    const double part = k < 3 ? 0 : (k == 3 ? 0.5 : 1);  // linear between samples
    EXPECT_LT((sensor.reading() - bias - part * F).norm(), 1e-12) << k;
  }
}

TEST(ForceSensor, LowPassLagsARampByItsTimeConstantAndASineByTheClosedForm) {
  SensorSpec spec = Exact();
  spec.cutoff_frequency = 150;
  for (const double dt : {0.001, 0.002}) {
    ForceSensor ramp(spec, Wrench::Zero(), dt, RandomStream(1, "test"));
    for (int k = 1; k <= 500; ++k) ramp.Step(Wrench::Constant(0.02 * k * dt));
    const double lag = 1 / (2 * std::numbers::pi * 150);
    EXPECT_NEAR(ramp.reading()[0], 0.02 * (500 * dt - lag), 1e-12);
  }
  const double w = 2 * std::numbers::pi * 20;
  ForceSensor sine(spec, Wrench::Zero(), kDt, RandomStream(1, "test"));
  double in_phase = 0, quadrature = 0;
  for (int k = 0; k < 2000; ++k) {
    sine.Step(Wrench::Constant(std::sin(w * k * kDt)));
    if (k < 1000) continue;
    in_phase += 2e-3 * sine.reading()[2] * std::sin(w * k * kDt);
    quadrature += 2e-3 * sine.reading()[2] * std::cos(w * k * kDt);
  }
  const double ratio = 20.0 / 150;
  EXPECT_NEAR(in_phase, 1 / (1 + ratio * ratio),
              2e-3);  // linear between samples, so not exactly a sine
  EXPECT_NEAR(quadrature, -ratio / (1 + ratio * ratio), 2e-3);
}

TEST(ForceSensor, NoiseAndQuantumAreAsSpecified) {
  SensorSpec spec = Exact();
  spec.noise_force = 0.05;
  spec.noise_torque = 0.002;
  spec.force_resolution = 0.02;
  ForceSensor sensor(spec, Wrench::Zero(), kDt, RandomStream(1, "test"));
  Vector6 sum = Vector6::Zero(), squares = Vector6::Zero();
  const int n = 100000;
  for (int k = 0; k < n; ++k) {
    sensor.Step(Wrench::Zero());
    const Wrench& F = sensor.reading();
    for (int i = 0; i < 3; ++i) ASSERT_NEAR(std::remainder(F[i], 0.02), 0, 1e-12);
    sum += F;
    squares += F.cwiseProduct(F);
  }
  for (int i = 0; i < 6; ++i) {
    const double expected = i < 3 ? std::hypot(0.05, 0.02 / std::sqrt(12.0)) : 0.002;
    EXPECT_NEAR(sum[i] / n, 0, 4 * expected / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares[i] / n), expected, 4 * expected / std::sqrt(2.0 * n));
  }
}

TEST(ForceSensor, FlagsAndClipsWhatIsBeyondItsRange) {
  ForceSensor sensor(Exact(), Wrench::Zero(), kDt, RandomStream(1, "test"));
  Wrench F = Wrench::Zero();
  F[1] = -200;
  sensor.Step(F);
  EXPECT_FALSE(sensor.saturated());
  F[1] = -201;
  sensor.Step(F);
  EXPECT_TRUE(sensor.saturated());
  EXPECT_EQ(sensor.reading()[1], -200);
  F << 0, 0, 0, 0, 0, 10.5;
  sensor.Step(F);
  EXPECT_TRUE(sensor.saturated());
  F.setZero();
  sensor.Step(F);
  EXPECT_FALSE(sensor.saturated());
}

// Simulates a force that rises by `rate` [N/s]. In the first sample above the threshold, the force
// exceeds the threshold by the fraction `beyond` of the rise per sample. Returns the number of
// samples from this sample to the first reading that exceeds the threshold.
int SamplesUntilSeen(const SensorSpec& spec, double rate, double beyond, std::uint64_t seed) {
  constexpr double kThreshold = 30;  // [N]
  constexpr int kBefore = 50;        // samples
  const auto force = [&](int k) -> Wrench {
    return (kThreshold + rate * kSample * (k + beyond)) * Wrench::Unit(2);
  };
  ForceSensor sensor(spec, Wrench::Zero(), kSample, RandomStream(seed, "sensor"));
  sensor.Reset(force(-kBefore));
  for (int k = 1 - kBefore; k < kBefore; ++k) {
    sensor.Step(force(k));
    if (sensor.reading()[2] > kThreshold) return k;
  }
  return kBefore;
}

// The monitor stops in the tick in which the reading exceeds its threshold. At any rate, the
// reading of a rising force lags by the delay plus the filter's time constant.
TEST(ForceSensor, ARisingForceIsSeenWithinThreeMilliseconds) {
  SensorSpec spec;
  const double lag = spec.delay + 1 / (2 * std::numbers::pi * spec.cutoff_frequency);
  SensorSpec exact = spec;
  exact.noise_force = exact.noise_torque = exact.force_resolution = exact.torque_resolution = 0;
  for (const double rate : {10.0, 100.0, 1000.0, 10'000.0})
    for (const double beyond : {0.01, 0.05, 0.25, 0.5, 0.75, 1.0}) {
      const int expected = static_cast<int>(std::ceil(lag / kSample - beyond));
      EXPECT_EQ(SamplesUntilSeen(exact, rate, beyond, 1), expected) << rate << " " << beyond;
      EXPECT_LE(expected, 3);
    }
  // Noise and resolution can hide less than 0.3 N. The force in this test rises by 0.3 N in 1 ms.
  // This millisecond is the last of the three milliseconds that the test allows.
  for (std::uint64_t seed = 1; seed <= 1000; ++seed)
    EXPECT_LE(SamplesUntilSeen(spec, 300, 0.01, seed), 3) << seed;
}

}  // namespace
}  // namespace predictor
