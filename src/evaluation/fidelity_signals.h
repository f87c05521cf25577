// Compares two signals. All functions are pure and require samples at one constant rate.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace predictor {

// Returns the number of turns of a planar path up to each sample, starting at 0 [cycles]. The
// number of turns follows from the unwrapped angle about the centre of the best-fitting circle. It
// increases in either direction of rotation. The phase never decreases. While the path moves
// backwards, the phase is constant. Samples far inside the circle, which occur before the path is
// reached, do not change the phase. All values are 0 for a path without extent. The arrays x and y
// [m] must have the same length.
std::vector<double> CyclePhase(std::span<const double> x, std::span<const double> y);

// Returns the number of whole cycles in a phase. The last cycle may be up to 2 % too short. In this
// case, its last value is repeated.
std::size_t CyclesIn(std::span<const double> phase);

// Returns the last time at which the phase has the value `at`, interpolated between samples
// [samples]. If the phase pauses before a cycle, the result is the end of the pause. `at` must be
// within the range of the phase.
double PlaceOfPhase(std::span<const double> phase, double at);

// Returns one cycle of a signal, from phase `cycle` to `cycle` + 1. The cycle is sampled with
// linear interpolation at `points` equal steps of the phase, including the first and excluding the
// last.
std::vector<double> CutCycle(std::span<const double> samples, std::span<const double> phase,
                             std::size_t cycle, std::size_t points);

// Returns the root mean square of the difference of two signals of the same length, or NaN if the
// signals are empty.
double RootMeanSquareError(std::span<const double> a, std::span<const double> b);
double RootMeanSquare(std::span<const double> a);

struct Lag {
  double samples = 0;      // positive: b is later than a; interpolated by a parabola
  double correlation = 0;  // Pearson's correlation of the overlapping parts at the nearest whole
                           // lag
};
// Returns the shift with the largest correlation among shifts of at most `longest` samples, or NaN
// if either signal is constant.
Lag LagOf(std::span<const double> a, std::span<const double> b, std::size_t longest);

// Computes the distance by dynamic time warping. This is the smallest sum of |a[i] − b[j]| along a
// path from the first to the last pair, divided by the longer length. Each step of the path
// increases i, j or both. The path remains within `band` of the diagonal, which is a share of the
// longer length. Returns NaN for empty signals.
double WarpedDistance(std::span<const double> a, std::span<const double> b, double band = 0.1);

struct Coherence {
  double mean = 0;    // mean squared coherence, with the weight √(S_aa S_bb) for each frequency
  double chance = 0;  // unrelated noise stays below this value at one frequency in 95 % of cases
  std::size_t segments = 0;
};
// Computes the coherence with Welch's method, from 0 (excluded) to `highest` [Hz]. The segments
// have `segment` samples and overlap by half. The mean of each segment is removed, and a Hann
// window is applied. Returns NaN if there are fewer than two segments or no power. `chance` treats
// only non-overlapping segments as independent.
Coherence CoherenceOf(std::span<const double> a, std::span<const double> b, double rate,
                      std::size_t segment, double highest);

// Compares the distance between two sets of repeats with the distances within each set.
struct RepeatComparison {
  double within = 0;   // rms difference of two repeats of the same set; both sets have equal weight
  double between = 0;  // rms difference between a repeat of one set and a repeat of the other
  double ratio = 0;    // between / within; about 1 if both sets are of the same kind
};
// All repeats have the same length. The result is NaN if a set has fewer than two repeats.
RepeatComparison CompareRepeats(const std::vector<std::vector<double>>& a,
                                const std::vector<std::vector<double>>& b);

}  // namespace predictor
