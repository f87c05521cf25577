// Computes how fast a limit may be approached.
#pragma once

#include "scenario/formulation.h"

namespace predictor {

// Returns the largest speed [·/s] at which a distance [·] may shrink. At this speed, the distance
// never falls below zero even if the deceleration is at most `acceleration`. For small distances,
// the speed is proportional to the distance (velocity damper with slope `gain` [1/s]). At larger
// distances, the speed follows a parabola, which continues this line smoothly. For negative
// distances, the speed is zero.
double ApproachSpeed(double distance, double gain, double acceleration) noexcept;

// The velocity damper of a limit, either in the form printed in the paper or with our repairs.
struct VelocityDamper {
  double gain = 0;          // slope [1/s]
  double influence = 0;     // distance beyond which the paper's damper does not act [·]
  double acceleration = 0;  // of the parabola [·/s²]
  bool ends = true;         // at a negative distance, Speed() is zero and not negative
  bool has_parabola = true;

  VelocityDamper() = default;
  VelocityDamper(double gain, double influence, double acceleration, const RepairSet& repairs);
  // Returns the largest speed [·/s] at which the distance may shrink, or kUnlimited if this speed
  // is not limited.
  double Speed(double distance) const noexcept;
  static constexpr double kUnlimited = 1e30;
};

}  // namespace predictor
