// Estimates the dynamics of the object that a hand on the object would feel. The estimate uses
// motion and force.
#pragma once

#include <span>
#include <vector>

#include "evaluation/fidelity.h"

namespace predictor {

// The coefficients of force = mass · a + viscosity · v + stiffness · x + constant along one axis.
// The coefficients are determined by least squares.
struct ApparentImpedance {
  double mass = 0;       // [kg]
  double viscosity = 0;  // [N·s/m]
  double stiffness = 0;  // [N/m]
  // States how far the acceleration deviates from being proportional to the position, from 0 to 1.
  // For a single sine, the deviation is 0, and mass and stiffness cannot be distinguished.
  double separable = 0;
};
inline constexpr double kSeparable = 0.05;  // below this value, mass and stiffness cannot be
                                            // distinguished: mass is set to 0

// position [m] and force [N] are sampled at kFidelityRate and smoothed over `span` [s]. The result
// is NaN if there are too few samples or if the standard deviation of the motion along the axis is
// below 5 mm. If the motion along the axis is smaller, the person does not lead the object, and the
// result would describe the hand.
ApparentImpedance FitImpedance(std::span<const double> position, std::span<const double> force,
                               double span = 0.4);

// Compares quantities of two runs and determines whether a person would notice their difference.
// `parts` are the ranges of samples that count as repeats. They are the cycles, or a single range
// of all samples.
struct SampleRange {
  std::size_t begin = 0, end = 0;
};
std::vector<PerceivedQuantity> ComparePerceived(const FidelitySignals& a,
                                                std::span<const SampleRange> parts_a,
                                                const FidelitySignals& b,
                                                std::span<const SampleRange> parts_b);

// Computes the difference, the error of the difference and the verdict from means and standard
// errors.
PerceivedQuantity Perceive(PerceivedQuantity quantity);

}  // namespace predictor
