// Two signals held against one another: pure functions over samples at one steady rate.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace predictor {

// How often a path in a plane has gone round, at each sample, from 0 on [cycles]: the angle about
// the centre of the circle that fits it best, unwrapped, upward whichever way it goes. It never
// goes back: where the path does, the phase waits. Samples far inside the circle (before the path
// is joined) do not move it. All 0 for a path without extent. x, y of the same length [m].
std::vector<double> CyclePhase(std::span<const double> x, std::span<const double> y);

// Whole cycles in a phase; the last may be 2 % short (its end is then held).
std::size_t CyclesIn(std::span<const double> phase);

// The time at which a phase is left for good, between samples [samples]: where it waits before a
// cycle, the end of waiting. `at` is within the phase's range.
double PlaceOfPhase(std::span<const double> phase, double at);

// One cycle of a signal, from phase `cycle` to `cycle` + 1, at `points` steady steps of the phase
// (the first included, the last not), linear between samples.
std::vector<double> CutCycle(std::span<const double> samples, std::span<const double> phase,
                             std::size_t cycle, std::size_t points);

// Of two signals of the same length; NaN of none.
double RootMeanSquareError(std::span<const double> a, std::span<const double> b);
double RootMeanSquare(std::span<const double> a);

struct Lag {
  double samples = 0;      // positive: b comes after a; between samples by a parabola
  double correlation = 0;  // Pearson's, of the parts that overlap at the nearest whole lag
};
// The shift by at most `longest` samples at which the two correlate best; NaN if either is
// constant.
Lag LagOf(std::span<const double> a, std::span<const double> b, std::size_t longest);

// Dynamic time warping: the least sum of |a[i] − b[j]| along a path from first to last that steps
// in i, in j or in both and stays within `band` of the diagonal (share of the longer length),
// divided by the longer length. NaN of none.
double WarpedDistance(std::span<const double> a, std::span<const double> b, double band = 0.1);

struct Coherence {
  double mean = 0;    // of the squared coherence, each frequency weighted by √(S_aa S_bb)
  double chance = 0;  // unrelated noise stays below this at one frequency, 95 times of 100
  std::size_t segments = 0;
};
// Welch's estimate from 0 (without) to `highest` [Hz]: Hann windows of `segment` samples, half
// overlapping, each without its mean. NaN if there are fewer than two segments, or no power.
// `chance` counts the segments as independent where they do not overlap.
Coherence CoherenceOf(std::span<const double> a, std::span<const double> b, double rate,
                      std::size_t segment, double highest);

// How far two sets of repeats lie apart, beside how far each lies from itself.
struct RepeatComparison {
  double within = 0;   // rms difference of two repeats of the same set, the sets counting alike
  double between = 0;  // rms difference of a repeat of one and a repeat of the other
  double ratio = 0;    // between / within: 1 is expected if the sets are of one kind
};
// All repeats of the same length. NaN where a set has fewer than two.
RepeatComparison CompareRepeats(const std::vector<std::vector<double>>& a,
                                const std::vector<std::vector<double>>& b);

}  // namespace predictor
