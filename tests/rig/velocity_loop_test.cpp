#include "rig/velocity_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "support/constants.h"

namespace predictor {
namespace {

using Complex = std::complex<double>;
constexpr double kNoLimit = 1e9;

VelocityLoop Unlimited(double bandwidth, double damping_ratio, double delay) {
  return {{bandwidth, damping_ratio, delay}, delay, kDt, kNoLimit, kNoLimit};
}

// Returns the velocity of the second-order loop at time t after a step. StepPosition is its
// integral.
double StepVelocity(double omega, double zeta, double t) {
  if (t <= 0) return 0;
  const double d = omega * std::sqrt(1 - zeta * zeta);
  return 1 - std::exp(-zeta * omega * t) *
                 (std::cos(d * t) + zeta / std::sqrt(1 - zeta * zeta) * std::sin(d * t));
}

double StepPosition(double omega, double zeta, double t) {
  // If v'' + 2 ζ ω v' + ω² v = ω² is integrated once from rest, it gives q = t − (v' + 2 ζ ω v)/ω².
  if (t <= 0) return 0;
  const double d = omega * std::sqrt(1 - zeta * zeta);
  const double a = omega * omega / d * std::exp(-zeta * omega * t) * std::sin(d * t);
  return t - (a + 2 * zeta * omega * StepVelocity(omega, zeta, t)) / (omega * omega);
}

TEST(VelocityLoop, StepResponseIsTheClosedFormForAnyDelay) {
  for (const double delay : {0.0, 0.004, 0.0043, 0.0109, 0.1}) {
    VelocityLoop loop = Unlimited(15, 0.9, delay);
    const double omega = 2 * std::numbers::pi * 15;
    for (int k = 1; k <= 300; ++k) {
      loop.Step(1);
      ASSERT_NEAR(loop.v(), StepVelocity(omega, 0.9, k * kDt - delay), 1e-11) << delay << " " << k;
      ASSERT_NEAR(loop.q(), StepPosition(omega, 0.9, k * kDt - delay), 1e-11) << delay << " " << k;
    }
  }
}

TEST(VelocityLoop, NothingMovesBeforeTheDelayHasPassed) {
  VelocityLoop loop = Unlimited(25, 0.7, 0.0145);
  for (int k = 1; k <= 14; ++k) {
    loop.Step(1);
    ASSERT_EQ(loop.v(), 0);
  }
  loop.Step(1);
  EXPECT_GT(loop.v(), 0);
}

// Returns the response at the sampling instants to a sampled and held sinusoid. The hold and its
// images pass through the loop.
Complex Response(double omega, double zeta, double delay, double w) {
  Complex sum = 0;
  for (int k = -200; k <= 200; ++k) {
    const Complex s(0, w + k * 2 * std::numbers::pi / kDt);
    const Complex hold = (1.0 - std::exp(-s * kDt)) / (s * kDt);
    sum += hold * std::exp(-s * delay) * omega * omega /
           (s * s + 2 * zeta * omega * s + omega * omega);
  }
  return sum;
}

TEST(VelocityLoop, FrequencyResponseHasTheGainAndPhaseOfTheModel) {
  for (const double bandwidth : {10.0, 15.0, 100.0}) {
    for (const double frequency : {0.5, 2.0, 5.0, 15.0, 40.0}) {
      const double delay = 0.0043;
      VelocityLoop loop = Unlimited(bandwidth, 0.9, delay);
      const double w = 2 * std::numbers::pi * frequency;
      const int settle = 2000, n = 2000;  // a whole number of periods
      Complex phasor = 0;
      for (int k = 0; k < settle + n; ++k) {
        loop.Step(std::cos(w * k * kDt));
        const double t = (k + 1) * kDt;
        if (k >= settle) phasor += 2.0 / n * loop.v() * std::exp(Complex(0, -w * t));
      }
      const Complex expected = Response(2 * std::numbers::pi * bandwidth, 0.9, delay, w);
      EXPECT_NEAR(std::abs(phasor) / std::abs(expected), 1, 1e-5) << bandwidth << " " << frequency;
      EXPECT_NEAR(std::arg(phasor / expected), 0, 1e-5) << bandwidth << " " << frequency;
    }
  }
}

TEST(VelocityLoop, NeverExceedsItsLimits) {
  RandomStream random(3, "test");
  for (const double damping_ratio : {0.2, 0.9, 1.5}) {
    VelocityLoop loop({30, damping_ratio, 0.004}, 0.004, kDt, 2.0, 10.0);
    double u = 0, before = 0, fastest = 0, hardest = 0;
    for (int k = 0; k < 200000; ++k) {
      if (random.Uniform() < 0.01) u = 8 * (2 * random.Uniform() - 1);
      loop.Step(u);
      ASSERT_LE(std::abs(loop.v()), 2.0);
      ASSERT_LE(std::abs(loop.a()), 10.0);
      ASSERT_LE(std::abs(loop.v() - before), 10.0 * kDt * (1 + 1e-9));
      fastest = std::max(fastest, std::abs(loop.v()));
      hardest = std::max(hardest, std::abs(loop.a()));
      before = loop.v();
    }
    EXPECT_EQ(fastest, 2.0);  // the motion reached the limits, so the test can detect them
    EXPECT_EQ(hardest, 10.0);
  }
}

TEST(VelocityLoop, ReachesTheCommandAfterALimit) {
  VelocityLoop loop({15, 0.9, 0.004}, 0.004, kDt, 2.0, 3.0);
  for (int k = 0; k < 2000; ++k) loop.Step(1.5);
  EXPECT_NEAR(loop.v(), 1.5, 1e-6);
  for (int k = 0; k < 2000; ++k) loop.Step(5);
  EXPECT_NEAR(loop.v(), 2.0, 1e-6);
}

TEST(VelocityLoop, PositionIsTheIntegralOfVelocity) {
  // For a smooth input, the trapezoidal rule is accurate to second order, with or without limits.
  VelocityLoop loop({15, 0.9, 0.004}, 0.004, kDt, 0.8, 4.0);
  double integral = 0, before = 0;
  for (int k = 0; k < 5000; ++k) {
    loop.Step(std::sin(2 * std::numbers::pi * k * kDt));
    integral += (before + loop.v()) * kDt / 2;
    before = loop.v();
    ASSERT_NEAR(loop.q(), integral, 2e-6);
  }
}

}  // namespace
}  // namespace predictor
