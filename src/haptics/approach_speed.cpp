#include "haptics/approach_speed.h"

#include <algorithm>
#include <cmath>

namespace predictor {

double ApproachSpeed(double distance, double gain, double acceleration) noexcept {
  if (distance <= 0) return 0;
  // On the line v = gain·d, the deceleration is gain·v. At this distance, the deceleration reaches
  // `acceleration`. At larger distances, the speed follows a parabola with this deceleration, which
  // begins with the same slope.
  const double joint = acceleration / (gain * gain);
  if (distance <= joint) return gain * distance;
  return std::sqrt(2 * acceleration * (distance - joint / 2));
}

VelocityDamper::VelocityDamper(double slope, double distance, double deceleration,
                               const RepairSet& repairs)
    : gain(slope),
      influence(distance),
      acceleration(deceleration),
      ends(repairs.Has(Repair::kDamperEnd)),
      has_parabola(repairs.Has(Repair::kApproachParabola)) {}

double VelocityDamper::Speed(double distance) const noexcept {
  if (distance < 0 && !ends) return gain * distance;
  if (has_parabola) return ApproachSpeed(distance, gain, acceleration);
  return distance <= influence ? gain * std::max(0.0, distance) : kUnlimited;
}

}  // namespace predictor
