#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/population/population.h"
#include "core/format.h"
#include "ergonomics/damage.h"
#include "evaluation/statistics_samples.h"

namespace predictor::population {
namespace {

constexpr double kTwoSided95 = 1.959963984540054;  // quantile of the normal distribution

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// The value of a whole run, or the range that a stopped run leaves open.
struct KnownValue {
  double low = 0, high = 0;
  bool exact() const { return low == high; }
};

// Returns nothing if a whole run has no value.
std::optional<KnownValue> KnownOf(const PopulationRun& run, std::size_t quantity) {
  if (quantity >= run.values.size()) return {};
  const double value = run.values[quantity];
  if (run.cause == StopCause::kNone)
    return std::isfinite(value) ? std::optional(KnownValue{value, value}) : std::nullopt;
  KnownValue known = {-kInfinite, kInfinite};
  if (!std::isfinite(value)) return known;
  if (StudyQuantities()[quantity].bad == assessment::Bad::kHigh)
    known.low = value;
  else
    known.high = value;
  return known;
}

// Returns the quantile of values that are known exactly or as bounds in the bad direction, which is
// up if `sign` is 1, and down if it is -1.
CensoredValue QuantileOf(std::span<const CensoredValue> badness, double probability, double sign) {
  CensoredValue quantile = CensoredQuantile(badness, sign > 0 ? probability : 1 - probability);
  quantile.value *= sign;
  return quantile;
}

DesignSummary SummaryOf(const PopulationDesign& design, std::size_t quantity) {
  const StudyQuantity& kind = StudyQuantities()[quantity];
  const double sign = kind.bad == assessment::Bad::kHigh ? 1 : -1;
  std::vector<CensoredValue> badness;
  DesignSummary summary;
  int beyond = 0, undecided = 0;
  for (const PopulationRun& run : design.runs) {
    const auto known = KnownOf(run, quantity);
    if (!known) continue;
    ++summary.people;
    summary.stopped += !known->exact();
    // A person about whom nothing is known does not influence the estimate of Kaplan and Meier.
    const double bound = sign > 0 ? known->low : known->high;
    if (std::isfinite(bound)) badness.push_back({sign * bound, !known->exact()});
    const bool exceeds = std::isfinite(bound) && kind.Exceeds(bound);
    beyond += exceeds;
    undecided += !exceeds && !known->exact();
  }
  summary.median = QuantileOf(badness, 0.5, sign);
  summary.p5 = QuantileOf(badness, 0.05, sign);
  summary.p95 = QuantileOf(badness, 0.95, sign);
  if (kind.has_limit()) summary.beyond = ShareOf(beyond, summary.people, undecided);
  return summary;
}

// Computes the shift and p. Both are monotonic in each difference, so their extremes follow from
// the smallest and from the largest possible differences.
void AddShift(std::span<const double> low, std::span<const double> high, PairedDifference* result) {
  const ShiftEstimate least = HodgesLehmann(low, 0.95), most = HodgesLehmann(high, 0.95);
  result->shift = {(least.estimate + most.estimate) / 2, least.lower, most.upper,
                   std::min(least.confidence, most.confidence)};
  const SignedRankTest at_least = TestSignedRank(low), at_most = TestSignedRank(high);
  const bool same_side = (at_least.plus > at_least.minus) == (at_most.plus > at_most.minus);
  result->p = result->p_holm = same_side ? std::max(at_least.p, at_most.p) : 1;
}

PairedDifference DifferenceOf(const PopulationStudy& study, std::size_t a, std::size_t b,
                              std::size_t quantity) {
  const bool high_is_bad = StudyQuantities()[quantity].bad == assessment::Bad::kHigh;
  std::vector<double> low, high;
  int better = 0, undecided = 0;
  const auto& of_a = study.designs[a].runs;
  const auto& of_b = study.designs[b].runs;
  for (std::size_t i = 0; i < std::min(of_a.size(), of_b.size()); ++i) {
    const auto in_a = KnownOf(of_a[i], quantity), in_b = KnownOf(of_b[i], quantity);
    if (!in_a || !in_b) continue;
    low.push_back(in_a->low - in_b->high);
    high.push_back(in_a->high - in_b->low);
    const bool surely = high_is_bad ? high.back() < 0 : low.back() > 0;
    const bool surely_not = high_is_bad ? low.back() >= 0 : high.back() <= 0;
    better += surely;
    undecided += !surely && !surely_not;
  }
  PairedDifference result = {a, b, quantity};
  result.better = ShareOf(better, static_cast<int>(low.size()), undecided);
  AddShift(low, high, &result);
  return result;
}

}  // namespace

int BeyondLifft(const PopulationDesign& design) {
  return static_cast<int>(std::ranges::count(design.runs, true, &PopulationRun::beyond_lifft));
}

std::string BeyondLifftSentence(const PopulationDesign& design) {
  const int people = BeyondLifft(design);
  if (people == 0) return "";
  return Formatted(
      "%s: for %d of %zu people, a load exceeds %.0f N·m, beyond the range of LiFFT, so their "
      "damage of the lower back is extrapolated.",
      design.name.c_str(), people, design.runs.size(), ergonomics::kLargestLiftMoment);
}

Share ShareOf(int count, int of, int undecided) {
  Share share = {count, of, undecided};
  if (of <= 0) return share;
  const double n = of, z2 = kTwoSided95 * kTwoSided95;
  const auto bound = [&](double p, double side) {
    const double centre = (p + z2 / (2 * n)) / (1 + z2 / n);
    const double half = kTwoSided95 / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
    return std::clamp(centre + side * half, 0.0, 1.0);
  };
  // At the ends, the formula gives exactly 0 and 1, apart from rounding errors.
  share.low = count == 0 ? 0 : bound(count / n, -1);
  share.high = count + undecided == of ? 1 : bound((count + undecided) / n, 1);
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
