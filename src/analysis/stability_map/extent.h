// Determines the hands for which a haptic loop is stable, with the linearised loop and by
// simulation.
#pragma once

#include <functional>
#include <vector>

#include "analysis/stability_map/growth.h"
#include "haptics/stability.h"
#include "scenario/scenario.h"

namespace predictor {

// A hand's stiffness is given by its largest component [N/m]. The rotational stiffness changes in
// proportion to this component (Varied).
struct StiffnessRange {
  double softest = 20, stiffest = 10000;  // [N/m]
};

// A stiffness at which the growth rate changes its sign.
struct Boundary {
  double stiffness = 0;      // [N/m]
  bool stable_below = true;  // stable below and unstable above; false: the reverse
  double frequency = 0;      // frequency of the oscillation on the unstable side [Hz]; 0: unknown
};

// The stable stiffnesses of a range.
struct StableExtent {
  bool stable_at_softest = true;
  std::vector<Boundary> boundaries;  // ascending

  bool StableAt(double stiffness) const;
  // `critical` is the lowest stiffness above which the loop becomes unstable. `least` is the lowest
  // stable stiffness if the loop is unstable with the softest hand. The functions critical() and
  // least() return null if there is no such boundary.
  const Boundary* critical() const;
  const Boundary* least() const;
  bool nothing_stable() const { return !stable_at_softest && boundaries.empty(); }
  bool everything_stable() const { return stable_at_softest && boundaries.empty(); }
};

// Predicts the extent with the linearised loop, for the scenario's hand with other stiffnesses.
// Boundaries are accurate to 1 %.
StableExtent PredictExtent(const HapticLoop& loop, const HandSpec& hand, double lead,
                           const StiffnessRange& range);

// The result of the simulation at one stiffness.
struct GrowthAt {
  double stiffness = 0;  // [N/m]
  Growth growth;
};
// Finds boundaries by simulation. The function evaluates the sign of the growth rate on a grid over
// the range and near `hints` [N/m]. Wherever the sign changes, it then bisects to 4 %. `samples`
// contains all simulated stiffnesses in ascending order.
struct FoundExtent {
  StableExtent extent;
  std::vector<GrowthAt> samples;
};
FoundExtent FindExtent(const std::vector<double>& hints, const StiffnessRange& range,
                       const std::function<Growth(double stiffness)>& measure);

}  // namespace predictor
