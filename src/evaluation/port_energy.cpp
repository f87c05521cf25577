#include "evaluation/port_energy.h"

#include <algorithm>

namespace predictor {

void PortEnergy::Add(double power, double dt) noexcept {
  sum += power * dt;
  lowest = std::min(lowest, sum);
  if (power < 0) {
    returned -= power * dt;
    peak_return = std::max(peak_return, -power);
  }
  if (sum < kEpisode && !below) ++episodes;
  below = sum < kEpisode;
}

}  // namespace predictor
