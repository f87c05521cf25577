// What a hand on the object would feel of its dynamics, out of motion and force.
#pragma once

#include <span>
#include <vector>

#include "evaluation/fidelity.h"

namespace predictor {

// Of force = mass · a + viscosity · v + stiffness · x + constant along one axis, by least squares.
struct ApparentImpedance {
  double mass = 0;       // [kg]
  double viscosity = 0;  // [N·s/m]
  double stiffness = 0;  // [N/m]
  // How far acceleration is from being proportional to position, 0 to 1: where the motion is one
  // sine it is, and mass and stiffness cannot be told apart.
  double separable = 0;
};
inline constexpr double kSeparable = 0.05;  // below, mass and stiffness are one: mass is taken as 0

// position [m] and force [N] at kFidelityRate, all of them smoothed over `span` seconds. NaN if
// there are too few samples, or if the axis moves less than 5 mm (standard deviation): then it is
// not the person who moves the object, and the figures would be the hand's.
ApparentImpedance FitImpedance(std::span<const double> position, std::span<const double> force,
                               double span = 0.4);

// The quantities of two runs and whether their difference would be noticed. `parts` are the
// samples' ranges that count as repeats: cycles; or one, the whole.
struct SampleRange {
  std::size_t begin = 0, end = 0;
};
std::vector<PerceivedQuantity> ComparePerceived(const FidelitySignals& a,
                                                std::span<const SampleRange> parts_a,
                                                const FidelitySignals& b,
                                                std::span<const SampleRange> parts_b);

// Out of means and standard errors: the difference, its error, and the verdict.
PerceivedQuantity Perceive(PerceivedQuantity quantity);

}  // namespace predictor
