// Computes how fast a limit may be approached.
#pragma once

#include "scenario/formulation.h"

namespace predictor {

// Returns the largest speed [1/s] at which a distance [·] may shrink so that it never falls below
// zero if the deceleration is at most `acceleration`. For small distances, the speed is
// proportional to the distance (velocity damper with slope `gain` [1/s]). A parabola continues
// smoothly at larger distances. For negative distances, the speed is zero.
double ApproachSpeed(double distance, double gain, double acceleration) noexcept;

// The velocity damper of a limit, either as printed in the paper or with our repairs.
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
