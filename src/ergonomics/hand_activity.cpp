#include "ergonomics/hand_activity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace predictor::ergonomics {

double HandActivityLevel(double frequency, double duty) {
  if (frequency <= 0 || duty <= 0) return 0;
  const double f = std::pow(frequency, 1.31);
  return std::clamp(6.56 * std::log(100 * duty) * f / (1 + 3.18 * f), 0.0, 10.0);
}

bool HandActivityWasStudied(double frequency, double duty) {
  return frequency >= 0.125 && frequency <= 1.67 && duty >= 0.11;
}

double HandActivityRatio(double normalized_force, double level) {
  if (normalized_force <= 0) return 0;
  if (level >= 10) return normalized_force * std::numeric_limits<double>::infinity();
  return normalized_force / (10 - level);
}

}  // namespace predictor::ergonomics
