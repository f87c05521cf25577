// Computes the energy that flows through a port between two systems.
#pragma once

#include <array>
#include <cstddef>

namespace predictor {

// Returns the power [W] of a wrench [N, N·m] on a body that moves with a twist [m/s, rad/s].
inline double Power(const std::array<double, 6>& wrench,
                    const std::array<double, 6>& twist) noexcept {
  double power = 0;
  for (std::size_t k = 0; k < 6; ++k) power += wrench[k] * twist[k];
  return power;
}

// The energy that flows through a port in both directions.
struct PortEnergy {
  double sum = 0;          // [J]
  double lowest = 0;       // lowest value of the running sum [J]
  double returned = 0;     // energy returned by the device, as a positive number [J]
  double peak_return = 0;  // peak power of that return [W]
  int episodes = 0;        // number of times the balance fell below kEpisode
  bool below = false;
  static constexpr double kEpisode = -0.05;  // [J]
  // Adds a power [W] over dt [s].
  void Add(double power, double dt) noexcept;
};

}  // namespace predictor
