// Rainflow counting finds the load cycles of a signal.
//
// Source: ASTM E1049-85, section 5.4.4 (three-point method). The worked example of this standard is
// one of our tests.
#pragma once

#include <span>
#include <vector>

namespace predictor::ergonomics {

struct LoadCycle {
  double range = 0;  // peak minus valley, in the signal's unit
  double mean = 0;   // mean of peak and valley
  double count = 1;  // 1, or 0.5 for a half cycle at the beginning or end of the signal
};

// Returns the cycles in the order in which they close. A cycle with a range below `min_range` (in
// the signal's unit) does not count. Otherwise, noise alone would add a cycle for each pair of
// samples.
std::vector<LoadCycle> CountRainflow(std::span<const double> signal, double min_range = 0);

}  // namespace predictor::ergonomics
