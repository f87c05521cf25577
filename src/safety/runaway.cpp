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

// For the input e^{λt}, the outputs of the two low-pass filters have the ratio (1 + λ kSlow) / (1 +
// λ kFast).
bool RunawayDetector::Trend::GrowsFasterThan(double rate) const noexcept {
  return fast > slow * (1 + rate * kSlow) / (1 + rate * kFast);
}

bool RunawayDetector::Update(const Vector3& force, const Vector3& velocity) noexcept {
  const double speed = velocity.norm();
  force_.Step(speed > 0 ? force.dot(velocity) / speed : 0, dt_);
  speed_.Step(speed, dt_);
  const bool some = speed_.fast > kMinSpeed * cap_ && force_.fast > kMinForce && force_.slow > 0;
  const bool faster = speed_.GrowsFasterThan(kMinGrowth) || speed_.fast > kAtCap * cap_;
  const bool grows =
      some && faster && force_.GrowsFasterThan(kMinGrowth) && !force_.GrowsFasterThan(kMaxGrowth);
  const bool counts = grows && speed_.fast > kSpeed * cap_ && force_.fast > kForce;
  growing_ = std::max(0.0, growing_ + (grows ? dt_ : -2 * dt_));
  time_ = std::max(0.0, time_ + (counts ? dt_ : -2 * dt_));
  return growing_ > kGrowing && time_ > kTime;
}

}  // namespace predictor
