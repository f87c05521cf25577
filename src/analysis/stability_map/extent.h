// For which hands a haptic loop is stable: by the linearised loop, and by simulation.
#pragma once

#include <functional>
#include <vector>

#include "analysis/stability_map/growth.h"
#include "haptics/stability.h"
#include "scenario/scenario.h"

namespace predictor {

// A hand's stiffness is told by its largest component [N/m]; rotation goes with it (Varied).
struct StiffnessRange {
  double softest = 20, stiffest = 10000;  // [N/m]
};

// Where growth changes its sign.
struct Boundary {
  double stiffness = 0;      // [N/m]
  bool stable_below = true;  // and unstable above, or the other way round
  double frequency = 0;      // of the oscillation on the unstable side [Hz]; 0: unknown
};

// Which stiffnesses of a range are stable.
struct StableExtent {
  bool stable_at_softest = true;
  std::vector<Boundary> boundaries;  // ascending

  bool StableAt(double stiffness) const;
  // The lowest stiffness that is too much, and below it the lowest that is enough; null: none.
  const Boundary* critical() const;
  const Boundary* least() const;
  bool nothing_stable() const { return !stable_at_softest && boundaries.empty(); }
  bool everything_stable() const { return stable_at_softest && boundaries.empty(); }
};

// By the linearised loop, with the scenario's hand otherwise. Boundaries to 1 %.
StableExtent PredictExtent(const HapticLoop& loop, const HandSpec& hand, double lead,
                           const StiffnessRange& range);

// What the simulation gave at one stiffness.
struct GrowthAt {
  double stiffness = 0;  // [N/m]
  Growth growth;
};
// By simulation: the sign of the growth on a grid over the range and beside `hints` [N/m], then by
// bisection to 4 % wherever it changes. `samples`: all that was simulated, ascending.
struct FoundExtent {
  StableExtent extent;
  std::vector<GrowthAt> samples;
};
FoundExtent FindExtent(const std::vector<double>& hints, const StiffnessRange& range,
                       const std::function<Growth(double stiffness)>& measure);

}  // namespace predictor
