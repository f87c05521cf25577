// Computes statistics of small stored samples: location, spread and quantiles.
#pragma once

#include <limits>
#include <span>
#include <vector>

namespace predictor {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// Without samples, the result is undefined, and each function returns kUndefined. SampleDeviation
// also returns kUndefined for a single sample.
double Mean(std::span<const double> samples);
// The denominator is n − 1.
double SampleDeviation(std::span<const double> samples);
double Median(std::span<const double> samples);
// Interpolates linearly between the order statistics, with the smallest sample at 0 and the largest
// at 1 (definition 7 of Hyndman & Fan). `probability` is from 0 to 1.
double Quantile(std::span<const double> samples, double probability);

// Returns Pearson's correlation, or NaN if either side is constant. Both sides must have the same
// length.
double Correlation(std::span<const double> a, std::span<const double> b);

// Applies Holm's step-down adjustment to several p values and returns them in the given order.
// The caller must compare each adjusted value with the common significance level.
std::vector<double> HolmAdjusted(std::span<const double> p);

}  // namespace predictor
