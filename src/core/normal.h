// The standard normal distribution.
#pragma once

namespace predictor {

// These functions are the cumulative distribution function of the standard normal distribution and
// its inverse (0 < probability < 1).
double NormalProbability(double z);
double NormalQuantile(double probability);

}  // namespace predictor
