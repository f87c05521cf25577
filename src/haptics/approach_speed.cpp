#include "haptics/approach_speed.h"

#include <cmath>

namespace predictor {

double ApproachSpeed(double distance, double gain, double acceleration) noexcept {
  if (distance <= 0) return 0;
  // On the line v = gain·d the deceleration is gain·v. It reaches `acceleration` at this distance;
  // beyond it a parabola of that deceleration continues with the same slope.
  const double joint = acceleration / (gain * gain);
  if (distance <= joint) return gain * distance;
  return std::sqrt(2 * acceleration * (distance - joint / 2));
}

}  // namespace predictor
