#include "scenario/perturbation.h"

#include <algorithm>
#include <cmath>

#include "core/minimum_jerk.h"

namespace predictor {
namespace {

// Returns the motion from rest to rest that covers the distance `length` in the time `time`.
struct Ramp {
  double length, time;

  double Position(double t) const { return length * MinimumJerk(t / time); }
  double Velocity(double t) const { return length / time * MinimumJerkRate(t / time); }
  double Acceleration(double t) const {
    const double s = std::clamp(t / time, 0.0, 1.0);
    return length / (time * time) * 60 * s * (1 - s) * (1 - 2 * s);
  }
};

}  // namespace

double PerturbationForce(const PerturbationSpec& perturbation, const HandSpec& hand) {
  constexpr int kSteps = 400;
  const Ramp ramp = {perturbation.amplitude, perturbation.ramp};
  const double end = perturbation.ramp + hand.reflex_delay + perturbation.ramp;
  double most = 0;
  for (const double stiffness : hand.stiffness) {
    const double damping = 2 * hand.damping_ratio * std::sqrt(hand.mass * stiffness);
    for (int k = 0; k <= kSteps; ++k) {
      const double t = end * k / kSteps, late = t - hand.reflex_delay;
      const double force =
          hand.mass * ramp.Acceleration(t) + damping * ramp.Velocity(t) +
          stiffness * ramp.Position(t) +
          hand.reflex_gain * (damping * ramp.Velocity(late) + stiffness * ramp.Position(late));
      most = std::max(most, std::abs(force));
    }
  }
  return most;
}

std::array<Vector3, 2> PerturbationPlane(const PerturbationSpec& perturbation) {
  const Vector3 n = perturbation.normal.normalized();
  const Vector3 first = std::abs(n.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 u = (first - n * n.dot(first)).normalized();
  return {u, n.cross(u)};
}

}  // namespace predictor
