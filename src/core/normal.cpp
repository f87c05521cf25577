#include "core/normal.h"

#include <cmath>
#include <numbers>

namespace predictor {

double NormalProbability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double NormalQuantile(double probability) {
  // Bisection is fast enough for a few calls per report, and its result is as accurate as the
  // function above. The upper half follows from symmetry, because probabilities near one lose
  // precision.
  if (probability > 0.5) return -NormalQuantile(1 - probability);
  double low = -39, high = 0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (NormalProbability(middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace predictor
