#include "safety/runaway.h"

#include <algorithm>

namespace predictor {
namespace {

constexpr double kFast = 0.010, kSlow = 0.050;  // time constants [s]

}  // namespace

void RunawayDetector::Trend::Step(double x, double dt) noexcept {
  fast += (x - fast) * std::min(1.0, dt / kFast);
  slow += (x - slow) * std::min(1.0, dt / kSlow);
}

// Of what grows by e^{kGrowth t} the low-passes lag as by their time constants.
bool RunawayDetector::Trend::Grows() const noexcept {
  return fast > slow * (1 + kGrowth * kSlow) / (1 + kGrowth * kFast);
}

bool RunawayDetector::Update(const Vector3& force, const Vector3& velocity) noexcept {
  const double speed = velocity.norm();
  force_.Step(speed > 0 ? force.dot(velocity) / speed : 0, dt_);
  speed_.Step(speed, dt_);
  const bool fast = speed_.fast > kSpeed * cap_;
  const bool faster = speed_.Grows() || speed_.fast > kAtCap * cap_;
  const bool runs = fast && faster && force_.fast > kForce && force_.slow > 0 && force_.Grows();
  time_ = std::max(0.0, time_ + (runs ? dt_ : -2 * dt_));
  return time_ > kTime;
}

}  // namespace predictor
