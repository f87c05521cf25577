// Responses of an arm whose parameters are known, to test their identification.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/identify_arm/arm_fit.h"
#include "core/random.h"

namespace predictor {

// Returns an arm whose matrices are symmetric but not diagonal.
inline PlaneVector KnownArm() {
  PlaneVector p;
  p << 1.6, 0.2, 1.1, 14, -2, 9, 320, 40, 120, 0.45, 0.07;
  return p;
}

inline Eigen::Matrix2d PlaneMatrixOf(const PlaneVector& p, int first) {
  Eigen::Matrix2d m;
  m << p[first], p[first + 1], p[first + 1], p[first + 2];
  return m;
}

// Simulates displacements in eight directions against a mass that hangs on a spring and a damper.
// The hand's force, which has noise with the standard deviation `noise` [N], moves the mass. The
// noise of the force therefore also moves the handle.
inline ArmResponses SimulatedResponses(const PlaneVector& arm, int count, double noise,
                                       std::uint64_t seed) {
  constexpr double kArmTick = 0.001, kAmplitude = 0.007, kRamp = 0.12;
  constexpr double kMass = 3, kStiffness = 200, kDamping = 15;  // of the object
  constexpr int kLead = 400, kBefore = 180, kAfter = 200;       // ticks
  const Eigen::Matrix2d M = PlaneMatrixOf(arm, plane::kMass),
                        D = PlaneMatrixOf(arm, plane::kDamping),
                        K = PlaneMatrixOf(arm, plane::kStiffness);
  const int late = static_cast<int>(std::lround(arm[plane::kDelay] / kArmTick));
  const Eigen::Matrix2d inverse = (M + kMass * Eigen::Matrix2d::Identity()).inverse();
  ArmResponses r;
  r.dt = kArmTick;
  r.before = kBefore;
  r.direction.resize(count, 2);
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (PlaneSignal* s : {&r.position, &r.velocity, &r.acceleration, &r.force})
      (*s)[axis].setZero(kBefore + kAfter, count);
  RandomStream random(seed, "arm responses");
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * (i % 8) / 8;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    r.direction.row(i) = direction;
    Eigen::Vector2d object = Eigen::Vector2d::Zero(), speed = object, e = object;
    std::vector<Eigen::Vector2d> x, v;
    for (int k = 0; k < kLead + kAfter; ++k) {
      const double s = std::clamp((k - kLead) * kArmTick / kRamp, 0.0, 1.0);
      const double u = s * s * s * (10 - 15 * s + 6 * s * s);
      const double du = 30 * s * s * (1 - s) * (1 - s) / kRamp;
      const double ddu = 60 * s * (1 - s) * (1 - 2 * s) / (kRamp * kRamp);
      x.push_back(object + kAmplitude * u * direction);
      v.push_back(speed + kAmplitude * du * direction);
      const std::size_t n = x.size() - 1, then = n >= static_cast<std::size_t>(late)
                                                     ? n - static_cast<std::size_t>(late)
                                                     : 0;
      e = 0.95 * e +
          noise * std::sqrt(1 - 0.95 * 0.95) * Eigen::Vector2d(random.Normal(), random.Normal());
      const Eigen::Vector2d spring =
          -(D * v[n] + K * x[n] + arm[plane::kGain] * (D * v[then] + K * x[then])) + e;
      const Eigen::Vector2d push = kAmplitude * ddu * direction;
      const Eigen::Vector2d acceleration =
          inverse * (spring - M * push - kDamping * speed - kStiffness * object);
      const Eigen::Vector2d force = spring - M * (acceleration + push);
      const int row = k - (kLead - kBefore);
      for (Eigen::Index axis = 0; row >= 0 && axis < 2; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        r.position[a](row, i) = x[n][axis];
        r.velocity[a](row, i) = v[n][axis];
        r.acceleration[a](row, i) = (acceleration + push)[axis];
        r.force[a](row, i) = force[axis];
      }
      object += kArmTick * speed;
      speed += kArmTick * acceleration;
    }
  }
  return r;
}

}  // namespace predictor
