// The standard normal distribution.
#pragma once

namespace predictor {

// Cumulative distribution function of the standard normal distribution and the inverse of this
// function (0 < probability < 1).
double NormalProbability(double z);
double NormalQuantile(double probability);

}  // namespace predictor
