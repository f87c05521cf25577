// Tests whether two sets of repeats have the same distribution, based on the distances between the
// repeats.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace predictor {

inline constexpr double kSignificance = 0.05;

struct SameKindTest {
  // The energy distance (Székely & Rizzo 2013) is the mean distance between repeats of different
  // sets minus the mean distance between repeats of the same set. Both sets have equal weight.
  double distance = 0;
  double p = 1;      // probability that randomly assigned repeats are at least as far apart as the
                     // actual sets
  double min_p = 1;  // smallest p possible with this number of repeats
  bool can_distinguish() const { return min_p <= kSignificance; }
  bool distinguished() const { return p <= kSignificance; }
};

// `a` and `b` contain repeats, each a series of the same length. The distance between two repeats
// is their rms difference. The test permutes whole repeats, because distances that share a repeat
// are correlated. If the sets have the same distribution, the test reports a difference in at most
// a share kSignificance of cases. This holds for every distribution. The test uses `draws`
// permutations, which are the same in each call. The actual division into sets counts as an
// additional permutation, so p is never too small (Phipson & Smyth 2010). Each set needs at least
// two repeats.
SameKindTest TestSameKind(std::span<const std::vector<double>> a,
                          std::span<const std::vector<double>> b, int draws = 9999);

}  // namespace predictor
