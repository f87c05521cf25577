// Wilcoxon's signed-rank test of paired differences, and the corresponding estimate of the shift.
#pragma once

#include <cstddef>
#include <span>

namespace predictor {

// Treatment of zero differences. In both cases, equal absolute values are given their mean rank.
enum class ZeroRule {
  kDropped,  // Wilcoxon (1949): dropped before ranking
  kPratt,    // Pratt (1959): ranked with the others, then dropped
};

// Up to this number of differences, the exact distribution is enumerated. For more differences, the
// normal approximation is used.
inline constexpr std::size_t kMaxEnumerated = 50;

struct SignedRankTest {
  std::size_t count = 0;       // number of differences
  std::size_t zeros = 0;       // number of zero differences
  std::size_t ranked = 0;      // number of ranked differences
  bool tied = false;           // some absolute values are equal
  double plus = 0, minus = 0;  // sums of the ranks of positive and negative differences
  bool exact = true;
  double z = 0;  // z value of the approximation, with continuity correction; 0 if exact
  double p = 1;  // two-sided p for the hypothesis that the differences are symmetric about zero; 1
                 // if all are zero
};

// An exact p is based on all 2^ranked sign assignments of the actual ranks, including ties. The
// approximation uses a continuity correction and the variance of the actual ranks. This variance
// accounts for ties. Absolute values are tied only if they are exactly equal. Therefore, round
// measured values first.
SignedRankTest TestSignedRank(std::span<const double> differences,
                              ZeroRule zeros = ZeroRule::kDropped,
                              std::size_t max_enumerated = kMaxEnumerated);

struct ShiftEstimate {
  double estimate = 0;          // median of the Walsh averages (Hodges & Lehmann 1963)
  double lower = 0, upper = 0;  // confidence interval, closed
  // Lower bound of the interval's confidence. The bound is also valid for tied or discrete
  // differences (Noether 1967). If there are too few differences, this bound is below the requested
  // confidence, and the interval is the range of the differences.
  double confidence = 0;
};

// Returns the centre of symmetry of the differences, including zeros. The ends of the interval are
// Walsh averages. They are chosen with the distribution of the signed-rank statistic without ties.
// Without differences, the result is NaN.
ShiftEstimate HodgesLehmann(std::span<const double> differences, double confidence = 0.95,
                            std::size_t max_enumerated = kMaxEnumerated);

}  // namespace predictor
