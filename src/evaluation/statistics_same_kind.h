// Whether two sets of repeats are of one kind, judged by how far apart the repeats lie.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace predictor {

inline constexpr double kSignificance = 0.05;

struct SameKindTest {
  // Energy distance (Székely & Rizzo 2013): the mean distance of a repeat of one set and one of the
  // other, less the mean distance of two repeats of one set, the sets counting alike.
  double distance = 0;
  double p = 1;        // that repeats dealt to the two sets at random are as far apart, or farther
  double least_p = 1;  // that so few repeats can give
  bool can_tell() const { return least_p <= kSignificance; }
  bool told_apart() const { return p <= kSignificance; }
};

// `a` and `b`: repeats, each a series of the same length; their distance is the rms difference. By
// permutation of whole repeats, since the distances of pairs that share one hang together: of sets
// of one kind the share told apart is at most kSignificance, whatever they are distributed like.
// `draws` of them, always the same ones; the sets as they are count as one more, so that p is never
// too small (Phipson & Smyth 2010). At least two of each.
SameKindTest TestSameKind(std::span<const std::vector<double>> a,
                          std::span<const std::vector<double>> b, int draws = 9999);

}  // namespace predictor
