#include "analysis/stability_map/extent.h"

#include <algorithm>
#include <cmath>

#include "analysis/check/check.h"

namespace predictor {
namespace {

constexpr double kScanRatio = 1.35;  // ratio of successive predicted stiffnesses
constexpr double kPredictedPrecision = 1.01;
constexpr int kMinStiffnesses = 4;   // number of stiffnesses that are always simulated
constexpr double kBesideHint = 1.2;  // ratio of the stiffnesses simulated on either side of a hint
constexpr double kFoundPrecision = 1.04;
constexpr double kGrowing = 1e-4;  // [1/s], as for HapticLoop's margin

double Middle(double a, double b) { return std::sqrt(a * b); }

}  // namespace

bool StableExtent::StableAt(double stiffness) const {
  bool stable = stable_at_softest;
  for (const Boundary& b : boundaries)
    if (stiffness > b.stiffness) stable = !b.stable_below;
  return stable;
}

const Boundary* StableExtent::critical() const {
  for (const Boundary& b : boundaries)
    if (b.stable_below) return &b;
  return nullptr;
}

const Boundary* StableExtent::least() const {
  return stable_at_softest || boundaries.empty() ? nullptr : boundaries.data();
}

StableExtent PredictExtent(const HapticLoop& loop, const HandSpec& hand, double lead,
                           const StiffnessRange& range) {
  double frequency = 0;  // of the last unstable one
  const auto stable = [&](double stiffness) {
    double f = 0;
    const bool is_stable =
        loop.GrowthRate(Varied(hand, hand.mass, stiffness), lead, 1, &f) <= kGrowing;
    if (!is_stable) frequency = f;
    return is_stable;
  };
  StableExtent extent;
  extent.stable_at_softest = stable(range.softest);
  bool before = extent.stable_at_softest;
  const int steps =
      static_cast<int>(std::ceil(std::log(range.stiffest / range.softest) / std::log(kScanRatio)));
  const double ratio = std::pow(range.stiffest / range.softest, 1.0 / steps);
  for (int k = 1; k <= steps; ++k) {
    const double at = range.softest * std::pow(ratio, k);
    if (stable(at) == before) continue;
    double low = at / ratio, high = at;
    while (high > kPredictedPrecision * low) {
      const double middle = Middle(low, high);
      (stable(middle) == before ? low : high) = middle;
    }
    extent.boundaries.push_back({Middle(low, high), before, frequency});
    before = !before;
  }
  return extent;
}

FoundExtent FindExtent(const std::vector<double>& hints, const StiffnessRange& range,
                       const std::function<Growth(double stiffness)>& measure) {
  FoundExtent found;
  auto& samples = found.samples;
  std::vector<double> at;
  at.reserve(kMinStiffnesses + 2 * hints.size());
  const double ratio = range.stiffest / range.softest;
  for (int k = 0; k < kMinStiffnesses; ++k)
    at.push_back(range.softest * std::pow(ratio, static_cast<double>(k) / (kMinStiffnesses - 1)));
  for (const double hint : hints)
    for (const double beside : {hint / kBesideHint, hint * kBesideHint})
      at.push_back(std::clamp(beside, range.softest, range.stiffest));
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  for (const double stiffness : at) samples.push_back({stiffness, measure(stiffness)});
  for (std::size_t k = 0; k + 1 < samples.size();) {
    const bool changes = samples[k].growth.grows != samples[k + 1].growth.grows;
    if (!changes || samples[k + 1].stiffness <= kFoundPrecision * samples[k].stiffness) {
      ++k;
      continue;
    }
    const double middle = Middle(samples[k].stiffness, samples[k + 1].stiffness);
    samples.insert(samples.begin() + static_cast<std::ptrdiff_t>(k) + 1, {middle, measure(middle)});
  }
  StableExtent& extent = found.extent;
  extent.stable_at_softest = !samples.front().growth.grows;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const Growth &a = samples[k].growth, &b = samples[k + 1].growth;
    if (a.grows == b.grows) continue;
    const Growth& unstable = a.grows ? a : b;
    extent.boundaries.push_back(
        {Middle(samples[k].stiffness, samples[k + 1].stiffness), !a.grows, unstable.frequency});
  }
  return found;
}

}  // namespace predictor
