#include "scenario/perturbation_force.h"

#include <cmath>

namespace predictor {

double PerturbationForce(const PerturbationSpec& perturbation, const HandSpec& hand) {
  const double length = perturbation.amplitude, time = perturbation.ramp;
  const double stiffness = hand.stiffness.maxCoeff();
  const double damping = 2 * hand.damping_ratio * std::sqrt(hand.mass * stiffness);
  const double late = 1 + hand.reflex_gain;
  return hand.mass * 5.774 * length / (time * time) +
         late * (damping * 1.875 * length / time + stiffness * length);
}

}  // namespace predictor
