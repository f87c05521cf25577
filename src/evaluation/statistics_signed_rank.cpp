#include "evaluation/statistics_signed_rank.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/normal.h"
#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

// Returns twice the mean rank of each absolute value, so that the results are integers. The values
// are ascending.
std::vector<std::size_t> DoubledRanks(const std::vector<double>& sizes) {
  std::vector<std::size_t> ranks(sizes.size());
  for (std::size_t begin = 0; begin < sizes.size();) {
    std::size_t end = begin;
    while (end < sizes.size() && sizes[end] == sizes[begin]) ++end;
    std::fill(ranks.begin() + static_cast<std::ptrdiff_t>(begin),
              ranks.begin() + static_cast<std::ptrdiff_t>(end), begin + 1 + end);
    begin = end;
  }
  return ranks;
}

// Entry s is the number of the 2^n sign assignments for which the positive (doubled) ranks sum to
// s. The entries are integers up to 2^50, which a double represents exactly.
std::vector<double> CountSums(const std::vector<std::size_t>& ranks) {
  std::vector<double> counts(1 + std::accumulate(ranks.begin(), ranks.end(), std::size_t{0}));
  counts[0] = 1;
  std::size_t largest = 0;
  for (const std::size_t rank : ranks) {
    largest += rank;
    for (std::size_t s = largest; s >= rank; --s) counts[s] += counts[s - rank];
  }
  return counts;
}

double ExactTwoSided(const std::vector<std::size_t>& ranks, std::size_t smaller_sum) {
  const std::vector<double> counts = CountSums(ranks);
  double tail = 0;
  for (std::size_t s = 0; s <= smaller_sum; ++s) tail += counts[s];
  return std::min(1.0, std::ldexp(2 * tail, -static_cast<int>(ranks.size())));
}

// The place of the Walsh averages that bound the interval, and the confidence of this interval. The
// place is one plus the number of Walsh averages outside the interval on each side.
struct CriticalPlace {
  std::size_t place = 1;  // counted from 1
  double confidence = 0;
};

CriticalPlace EnumeratedPlace(std::size_t n, double alpha) {
  std::vector<std::size_t> ranks(n);
  std::iota(ranks.begin(), ranks.end(), 1);
  const std::vector<double> counts = CountSums(ranks);
  const auto share = [n](double tail) { return std::ldexp(tail, -static_cast<int>(n)); };
  CriticalPlace found{1, 1 - 2 * share(counts[0])};
  double tail = counts[0];
  for (std::size_t k = 1; k < counts.size() && 2 * share(tail + counts[k]) <= alpha; ++k) {
    tail += counts[k];
    found = {k + 1, 1 - 2 * share(tail)};
  }
  return found;
}

CriticalPlace ApproximatePlace(std::size_t n, double alpha) {
  const double count = static_cast<double>(n);
  const double mean = count * (count + 1) / 4;
  const double deviation = std::sqrt(count * (count + 1) * (2 * count + 1) / 24);
  const double place =
      std::max(1.0, std::floor(mean + 0.5 + NormalQuantile(alpha / 2) * deviation));
  return {static_cast<std::size_t>(place),
          1 - 2 * NormalProbability((place - 0.5 - mean) / deviation)};
}

}  // namespace

SignedRankTest TestSignedRank(std::span<const double> differences, ZeroRule zeros,
                              std::size_t max_enumerated) {
  SignedRankTest test;
  test.count = differences.size();
  std::vector<double> sorted(differences.begin(), differences.end());
  test.zeros = static_cast<std::size_t>(std::count(sorted.begin(), sorted.end(), 0.0));
  test.ranked = test.count - test.zeros;
  if (zeros == ZeroRule::kDropped) std::erase(sorted, 0.0);
  std::sort(sorted.begin(), sorted.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  std::vector<double> sizes(sorted.size());
  std::transform(sorted.begin(), sorted.end(), sizes.begin(), [](double d) { return std::abs(d); });
  const std::vector<std::size_t> all_ranks = DoubledRanks(sizes);
  std::vector<std::size_t> ranks;
  std::size_t plus = 0, minus = 0;
  double variance = 0;  // variance of the sum of ranks
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (sorted[i] == 0) continue;
    test.tied |= i > 0 && sizes[i] == sizes[i - 1];
    ranks.push_back(all_ranks[i]);
    (sorted[i] > 0 ? plus : minus) += all_ranks[i];
    variance += static_cast<double>(all_ranks[i] * all_ranks[i]) / 16;
  }
  test.plus = static_cast<double>(plus) / 2;
  test.minus = static_cast<double>(minus) / 2;
  if (ranks.empty()) return test;
  test.exact = ranks.size() <= max_enumerated;
  if (test.exact) {
    test.p = ExactTwoSided(ranks, std::min(plus, minus));
    return test;
  }
  const double excess = (test.plus - test.minus) / 2;
  test.z = std::copysign(std::max(0.0, std::abs(excess) - 0.5), excess) / std::sqrt(variance);
  test.p = std::min(1.0, 2 * NormalProbability(-std::abs(test.z)));
  return test;
}

ShiftEstimate HodgesLehmann(std::span<const double> differences, double confidence,
                            std::size_t max_enumerated) {
  const std::size_t n = differences.size();
  if (n == 0) return {kUndefined, kUndefined, kUndefined, 0};
  std::vector<double> walsh;
  walsh.reserve(n * (n + 1) / 2);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) walsh.push_back((differences[i] + differences[j]) / 2);
  std::sort(walsh.begin(), walsh.end());
  const CriticalPlace critical = n <= max_enumerated ? EnumeratedPlace(n, 1 - confidence)
                                                     : ApproximatePlace(n, 1 - confidence);
  return {Median(walsh), walsh[critical.place - 1], walsh[walsh.size() - critical.place],
          critical.confidence};
}

}  // namespace predictor
