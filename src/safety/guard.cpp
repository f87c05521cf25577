#include "safety/guard.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor {

double BrakingSpeed(double distance, double acceleration, double reaction, double dt) noexcept {
  if (!(distance > 0)) return 0;
  // Solves v dt + v²/2a = distance. After a tick at the speed v, the remaining distance is at least
  // v²/2a, and the speed bound for the remaining distance is at least v − a dt. Braking along this
  // bound therefore never needs more than `acceleration`.
  const double step = acceleration * dt;
  const double v = std::sqrt(step * step + 2 * acceleration * distance) - step;
  return std::max(0.0, v - acceleration * reaction);
}

double ReactionTime(const VelocityLoopSpec& loop) noexcept {
  const double w = 2 * std::numbers::pi * loop.bandwidth, zeta = loop.damping_ratio;
  // Computes the cumulants of 1/(1 + 2ζ s/w + s²/w²). The second cumulant is negative if the loop
  // overshoots strongly.
  const double mean = loop.delay + 2 * zeta / w;
  const double variance = std::max(0.0, (4 * zeta * zeta - 2) / (w * w));
  return std::sqrt(mean * mean + variance);
}

Guard::Guard(const std::array<JointBounds, kHands>& bounds, double dt, double reaction)
    : bounds_(bounds), dt_(dt), reaction_(reaction) {
  Reset();
}

void Guard::Reset() noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm) last_[arm].setZero(bounds_[arm].lower.size());
}

bool Guard::MayRestNext() const noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm)
    if ((last_[arm].array().abs() > bounds_[arm].acceleration.array() * dt_).any()) return false;
  return true;
}

bool Guard::Trusted(const std::array<JointVector, kHands>& q,
                    const std::array<JointVector, kHands>& v) const noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const Eigen::Index joints = bounds_[arm].lower.size();
    if (v[arm].size() != joints || q[arm].size() != joints) return false;
    if (!v[arm].allFinite() || !q[arm].allFinite()) return false;
  }
  return true;
}

// Returns the smallest factor by which the last command of both arms can be scaled in one tick
// without exceeding the acceleration bound of any joint.
double Guard::BrakingFactor() const noexcept {
  double relative = 1;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    for (Eigen::Index i = 0; i < last_[arm].size(); ++i) {
      const double step = bounds_[arm].acceleration[i] * dt_;
      const double speed = std::abs(last_[arm][i]);
      if (speed > step) relative = std::min(relative, step / speed);
    }
  }
  return 1 - relative;
}

double Guard::Bound(int arm, int joint, double q, double v, int ticks) const noexcept {
  const JointBounds& bounds = bounds_[static_cast<std::size_t>(arm)];
  const double last = last_[static_cast<std::size_t>(arm)][joint];
  const double a = bounds.acceleration[joint];
  const double slower = std::min(ticks * a * dt_, std::max(a * dt_, std::abs(last)));
  v = std::clamp(v, last - (last > 0 ? slower : a * dt_), last + (last < 0 ? slower : a * dt_));
  // If a position is unknown, only the velocity bound applies. In this case, the command brakes
  // because of the velocity bound.
  const double cap = bounds.velocity[joint];
  if (!std::isfinite(q)) return std::clamp(v, -cap, cap);
  const double up = std::min(cap, BrakingSpeed(bounds.upper[joint] - q, a, reaction_, dt_));
  const double down = std::min(cap, BrakingSpeed(q - bounds.lower[joint], a, reaction_, dt_));
  return std::clamp(v, -down, up);
}

int Guard::Slow(double factor, std::array<JointVector, kHands>* v,
                double last_factor) const noexcept {
  const double keep = std::max(last_factor, BrakingFactor());
  double share = 1;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    if ((*v)[arm].size() != last_[arm].size()) return 0;
    for (Eigen::Index i = 0; i < last_[arm].size(); ++i) {
      const double from = keep * last_[arm][i], way = factor * (*v)[arm][i] - from;
      const double braked = from - last_[arm][i];
      const double room = bounds_[arm].acceleration[i] * dt_ - (way > 0 ? braked : -braked);
      if (std::abs(way) > room) share = std::min(share, room / std::abs(way));
    }
  }
  int altered = 0;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    for (Eigen::Index i = 0; i < last_[arm].size(); ++i) {
      const double asked = (*v)[arm][i], goal = factor * asked, from = keep * last_[arm][i];
      (*v)[arm][i] = share < 1 ? from + share * (goal - from) : goal;
      if ((*v)[arm][i] != asked) ++altered;
    }
  }
  return altered;
}

int Guard::Apply(const std::array<JointVector, kHands>& q, std::array<JointVector, kHands>* v,
                 int ticks) noexcept {
  const bool trusted = Trusted(q, *v);
  const double factor = trusted ? 1 : BrakingFactor();
  int altered = 0;
  for (int arm = 0; arm < kHands; ++arm) {
    JointVector& command = (*v)[static_cast<std::size_t>(arm)];
    JointVector& last = last_[static_cast<std::size_t>(arm)];
    const JointVector& position = q[static_cast<std::size_t>(arm)];
    command.conservativeResize(last.size());
    for (int i = 0; i < last.size(); ++i) {
      const double asked = trusted ? command[i] : factor * last[i];
      const double known = i < position.size() ? position[i] : std::nan("");
      command[i] = Bound(arm, i, known, asked, ticks);
      if (!trusted || command[i] != asked) ++altered;
    }
    last = command;
  }
  return altered;
}

}  // namespace predictor
