#include "scenario/stop_budget.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace predictor {
namespace {

// The budget of a stop from a given speed. The budget also covers handles that accelerate when the
// stop begins. The second entry applies if a handle may move faster than the speed of the first
// entry.
struct StopAllowance {
  double speed, time, way;  // [m/s], [s], [m]
};
constexpr StopAllowance kStopAllowances[] = {{0.25, 0.090, 0.0135}, {0.5, 0.140, 0.0398}};
// The largest deceleration [m/s²] and jerk [m/s³] of a stop. With larger values, the stop would be
// a blow to the person at the handle.
constexpr double kHardestStop = 10, kHardestStopJerk = 1000;

}  // namespace

StopBudget WorstStop(double speed, double acceleration, double jerk) {
  // The deceleration has three phases. In the first, a constant jerk leads from the acceleration at
  // the beginning to the peak deceleration. In the second, the peak deceleration is constant. In
  // the third, a constant jerk leads back to zero. The speed first grows to `speed`, by at most a
  // quarter (safety/stop.h). The stop of a slow handle never reaches the full deceleration.
  const double peak = std::min(acceleration, std::sqrt(jerk * speed));
  const double rate = std::min(acceleration, std::sqrt(0.4 * jerk * speed));
  const double begin = speed - rate * rate / (2 * jerk);
  const double in = (rate + peak) / jerk, out = peak / jerk, hold = speed / peak - out;
  const double then = begin + in * (rate - jerk * in / 2);
  return {in + hold + out, in * (begin + in * (rate / 2 - jerk * in / 6)) +
                               hold * (then - peak * hold / 2) + peak * out * out / 6};
}

std::string StopRefusal(double acceleration, double jerk, double fastest) {
  for (const StopAllowance& allowed : kStopAllowances) {
    const StopBudget budget = WorstStop(allowed.speed, acceleration, jerk);
    if (budget.time > allowed.time * (1 + 1e-9) || budget.way > allowed.way)
      return Formatted(
          "give a stop of %.0f ms and %.1f mm from %.2f m/s, but real arms must stop within %.0f "
          "ms and %.1f mm. Increase both values: 5 m/s² and 250 m/s³ are sufficient.",
          1e3 * budget.time, 1e3 * budget.way, allowed.speed, 1e3 * allowed.time,
          1e3 * allowed.way);
    if (fastest <= allowed.speed) break;
  }
  if (acceleration > kHardestStop || jerk > kHardestStopJerk)
    return Formatted(
        "give a stop that is too abrupt for the person at the handle. Real arms allow at most %.0f "
        "m/s² and %.0f m/s³.",
        kHardestStop, kHardestStopJerk);
  return "";
}

}  // namespace predictor
