// Computes the friction of a joint, which near standstill is a smooth function of the velocity.
#pragma once

#include <cmath>

namespace predictor {

// Returns the torque that opposes the velocity v [rad/s] of a joint with Coulomb friction [N·m] and
// viscous friction [N·m·s/rad]. Below 0.01 rad/s, Coulomb friction falls smoothly to 0.
inline double SmoothFriction(double coulomb, double viscous, double v) noexcept {
  constexpr double kSmooth = 0.01;  // [rad/s]
  return viscous * v + coulomb * std::tanh(v / kSmooth);
}

}  // namespace predictor
