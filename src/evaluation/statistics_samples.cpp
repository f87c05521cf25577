#include "evaluation/statistics_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "evaluation/statistics.h"

namespace predictor {
namespace {

Statistics Of(std::span<const double> samples) {
  Statistics statistics;
  for (const double x : samples) statistics.Add(x);
  return statistics;
}

}  // namespace

double Mean(std::span<const double> samples) {
  return samples.empty() ? kUndefined : Of(samples).mean();
}

double SampleDeviation(std::span<const double> samples) {
  return samples.size() < 2 ? kUndefined : Of(samples).std();
}

double Median(std::span<const double> samples) { return Quantile(samples, 0.5); }

double Quantile(std::span<const double> samples, double probability) {
  if (samples.empty()) return kUndefined;
  std::vector<double> sorted(samples.begin(), samples.end());
  std::sort(sorted.begin(), sorted.end());
  const double place = std::clamp(probability, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

double Correlation(std::span<const double> a, std::span<const double> b) {
  const double mean_a = Mean(a), mean_b = Mean(b);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double x = a[i] - mean_a, y = b[i] - mean_b;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : kUndefined;
}

std::vector<double> HolmAdjusted(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return p[i] < p[j]; });
  std::vector<double> adjusted(p.size());
  double largest = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double factor = static_cast<double>(order.size() - k);
    largest = std::max(largest, std::min(1.0, factor * p[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

}  // namespace predictor
