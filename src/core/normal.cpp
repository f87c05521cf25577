#include "core/normal.h"

#include <cmath>
#include <numbers>

namespace predictor {

double NormalProbability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double NormalQuantile(double probability) {
  // Bisection is fast enough for a few calls per report. Its result is as accurate as the
  // distribution function above. Probabilities near one lose precision, so the upper half is
  // computed from the lower half by symmetry.
  if (probability > 0.5) return -NormalQuantile(1 - probability);
  double low = -39, high = 0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (NormalProbability(middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace predictor
