// Computes how fast a limit may be approached.
#pragma once

#include "scenario/formulation.h"

namespace predictor {

// Returns the largest speed [1/s] at which a distance [·] may shrink so that it never falls below
// zero when deceleration is at most `acceleration`. It is proportional near zero (velocity damper
// with slope `gain` [1/s]) and a parabola beyond, joined smoothly. It is zero where the distance is
// negative.
double ApproachSpeed(double distance, double gain, double acceleration) noexcept;

// The velocity damper of a limit, as printed in the paper or with our repairs.
struct VelocityDamper {
  double gain = 0;          // slope [1/s]
  double influence = 0;     // distance beyond which the paper's damper does not act [·]
  double acceleration = 0;  // of the parabola [·/s²]
  bool ends = true;         // at a negative distance, Speed() is zero and not negative
  bool has_parabola = true;

  VelocityDamper() = default;
  VelocityDamper(double gain, double influence, double acceleration, const RepairSet& repairs);
  // Returns the largest speed [·/s] at which the distance may shrink, or kUnlimited if it is not
  // limited.
  double Speed(double distance) const noexcept;
  static constexpr double kUnlimited = 1e30;
};

}  // namespace predictor
