// Figures of small samples that are kept: location, spread, quantiles, the normal distribution.
#pragma once

#include <span>
#include <vector>

namespace predictor {

// Each is NaN where it is not defined: of no samples, SampleDeviation of fewer than two.
double Mean(std::span<const double> samples);
// With n − 1 in the denominator.
double SampleDeviation(std::span<const double> samples);
double Median(std::span<const double> samples);
// Linear between the order statistics, with the extremes at 0 and 1 (Hyndman & Fan's definition 7).
// probability: 0 to 1.
double Quantile(std::span<const double> samples, double probability);

// Pearson's correlation; NaN if either side does not vary. Both of the same length.
double Correlation(std::span<const double> a, std::span<const double> b);

// Of the standard normal distribution, and its inverse (0 < probability < 1).
double NormalProbability(double z);
double NormalQuantile(double probability);

// Holm's step-down adjustment of several p values: each is to be held against the level that all
// of them share. In the order given.
std::vector<double> HolmAdjusted(std::span<const double> p);

}  // namespace predictor
