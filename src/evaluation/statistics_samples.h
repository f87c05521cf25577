// Statistics of small stored samples: location, spread and quantiles.
#pragma once

#include <limits>
#include <span>
#include <vector>

namespace predictor {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// Each function returns kUndefined if the result is undefined: without samples, and for
// SampleDeviation also with one sample.
double Mean(std::span<const double> samples);
// The denominator is n − 1.
double SampleDeviation(std::span<const double> samples);
double Median(std::span<const double> samples);
// Linear interpolation between the order statistics, with the extremes at 0 and 1 (definition 7 of
// Hyndman & Fan). probability: 0 to 1.
double Quantile(std::span<const double> samples, double probability);

// Pearson's correlation; NaN if either side is constant. Both have the same length.
double Correlation(std::span<const double> a, std::span<const double> b);

// Holm's step-down adjustment of several p values, returned in the given order. Compare each
// adjusted value with the common significance level.
std::vector<double> HolmAdjusted(std::span<const double> p);

}  // namespace predictor
