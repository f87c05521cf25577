#include <algorithm>
#include <cmath>

#include "analysis/population/population.h"
#include "evaluation/statistics_samples.h"

namespace predictor::population {
namespace {

constexpr double kTwoSided95 = 1.959963984540054;  // quantile of the normal distribution

// Returns whether a run has a value that can be compared with the values of other runs. A run that
// was stopped is too short for a comparison.
bool IsWhole(const PopulationRun& run, std::size_t quantity) {
  return run.cause == StopCause::kNone && quantity < run.values.size() &&
         std::isfinite(run.values[quantity]);
}

DesignSummary SummaryOf(const PopulationDesign& design, std::size_t quantity) {
  const StudyQuantity& kind = StudyQuantities()[quantity];
  std::vector<double> values;
  for (const PopulationRun& run : design.runs)
    if (IsWhole(run, quantity)) values.push_back(run.values[quantity]);
  DesignSummary summary;
  summary.people = static_cast<int>(values.size());
  summary.median = Median(values);
  summary.p5 = Quantile(values, 0.05);
  summary.p95 = Quantile(values, 0.95);
  if (kind.has_limit())
    summary.beyond = ShareOf(
        static_cast<int>(std::ranges::count_if(values, [&](double x) { return kind.Exceeds(x); })),
        summary.people);
  return summary;
}

PairedDifference DifferenceOf(const PopulationStudy& study, std::size_t a, std::size_t b,
                              std::size_t quantity) {
  const double sign = StudyQuantities()[quantity].bad == assessment::Bad::kHigh ? 1 : -1;
  std::vector<double> differences;
  int better = 0;
  const auto& of_a = study.designs[a].runs;
  const auto& of_b = study.designs[b].runs;
  for (std::size_t i = 0; i < std::min(of_a.size(), of_b.size()); ++i) {
    if (!IsWhole(of_a[i], quantity) || !IsWhole(of_b[i], quantity)) continue;
    differences.push_back(of_a[i].values[quantity] - of_b[i].values[quantity]);
    better += sign * differences.back() < 0;
  }
  PairedDifference result = {a, b, quantity};
  result.better = ShareOf(better, static_cast<int>(differences.size()));
  result.shift = HodgesLehmann(differences, 0.95);
  result.p = result.p_holm = TestSignedRank(differences).p;
  return result;
}

}  // namespace

Share ShareOf(int count, int of) {
  Share share = {count, of};
  if (of <= 0) return share;
  const double n = of, z2 = kTwoSided95 * kTwoSided95;
  const double centre = (share.value() + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kTwoSided95 / (1 + z2 / n) *
                      std::sqrt(share.value() * (1 - share.value()) / n + z2 / (4 * n * n));
  share.low = std::max(0.0, centre - half);
  share.high = std::min(1.0, centre + half);
  return share;
}

void Compare(PopulationStudy* study) {
  const std::size_t quantities = StudyQuantities().size();
  study->summaries.clear();
  study->differences.clear();
  for (const PopulationDesign& design : study->designs) {
    auto& row = study->summaries.emplace_back();
    for (std::size_t q = 0; q < quantities; ++q) row.push_back(SummaryOf(design, q));
  }
  for (std::size_t a = 1; a < study->designs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      for (std::size_t q = 0; q < quantities; ++q)
        study->differences.push_back(DifferenceOf(*study, a, b, q));
  std::vector<double> p;
  for (const PairedDifference& d : study->differences) p.push_back(d.p);
  const std::vector<double> adjusted = HolmAdjusted(p);
  for (std::size_t i = 0; i < adjusted.size(); ++i) study->differences[i].p_holm = adjusted[i];
}

}  // namespace predictor::population
