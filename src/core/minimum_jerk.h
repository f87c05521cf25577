// Computes a movement with minimum jerk, from rest to rest (Flash & Hogan 1985).
#pragma once

#include <algorithm>

namespace predictor {

// Returns s(x) = 10x³ − 15x⁴ + 6x⁵, which rises from 0 to 1 for x in [0, 1]. Outside this range,
// the result is constant.
inline double MinimumJerk(double x) noexcept {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (-15 + 6 * x));
}

// Returns ds/dx, which is at most 1.875.
inline double MinimumJerkRate(double x) noexcept {
  x = std::clamp(x, 0.0, 1.0);
  return 30 * x * x * (1 - x) * (1 - x);
}

}  // namespace predictor
