// Wilcoxon's signed-rank test of paired differences, and the shift that goes with it.
#pragma once

#include <cstddef>
#include <span>

namespace predictor {

// What becomes of differences of zero. Equal sizes share the mean of their ranks either way.
enum class ZeroRule {
  kDropped,  // Wilcoxon (1949): left out before ranking
  kPratt,    // Pratt (1959): ranked with the others, then left out
};

// Up to here the distribution is enumerated; beyond, the normal approximation is used.
inline constexpr std::size_t kMostEnumerated = 50;

struct SignedRankTest {
  std::size_t count = 0;       // of differences
  std::size_t zeros = 0;       // among them
  std::size_t ranked = 0;      // that have a sign
  bool tied = false;           // some sizes are equal
  double plus = 0, minus = 0;  // sums of the ranks of positive and of negative differences
  bool exact = true;
  double z = 0;  // of the approximation, with continuity correction; 0 if exact
  double p = 1;  // two-sided, that the differences are symmetric about zero; 1 if none has a sign
};

// Exact p: over all 2^ranked signs of the ranks as they are, ties included. The approximation has
// the variance of the ranks as they are, which is the correction for ties, and one for continuity.
// Sizes count as equal if they are so as numbers: round what was measured first.
SignedRankTest TestSignedRank(std::span<const double> differences,
                              ZeroRule zeros = ZeroRule::kDropped,
                              std::size_t most_enumerated = kMostEnumerated);

struct ShiftEstimate {
  double estimate = 0;          // median of the Walsh averages (Hodges & Lehmann 1963)
  double lower = 0, upper = 0;  // confidence interval, closed
  // Of the interval, at least, also for tied or discrete differences (Noether 1967). It is below
  // what was asked for where so few differences cannot give that: then the interval is their range.
  double confidence = 0;
};

// The centre of symmetry of the differences, zeros included. The interval's ends are Walsh averages
// by the untied distribution of the signed-rank statistic. NaN without differences.
ShiftEstimate HodgesLehmann(std::span<const double> differences, double confidence = 0.95,
                            std::size_t most_enumerated = kMostEnumerated);

}  // namespace predictor
