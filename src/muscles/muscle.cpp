#include "muscles/muscle.h"

#include <algorithm>
#include <cmath>

namespace predictor::muscles {

Fibre FibreOf(const MuscleParameters& muscle, double path_length, double path_rate) {
  Fibre fibre;
  const double along = path_length - muscle.tendon_slack;
  if (along <= 0) return fibre;
  const double thickness = muscle.fibre_length * std::sin(muscle.pennation);
  const double length = std::hypot(along, thickness);
  fibre.cos_pennation = along / length;
  fibre.length = length / muscle.fibre_length;
  fibre.velocity = path_rate * fibre.cos_pennation / (kMaxVelocity * muscle.fibre_length);
  return fibre;
}

double ActiveForceLength(double length) {
  constexpr double kWidth = 0.45;
  return std::exp(-(length - 1) * (length - 1) / kWidth);
}

double PassiveForceLength(double length) {
  constexpr double kShape = 4, kStrain = 0.6;  // strain at which the passive force equals max_force
  return std::expm1(kShape * std::max(length - 1, 0.0) / kStrain) / std::expm1(kShape);
}

double ForceVelocity(double velocity) {
  constexpr double kMaxForce = 1.2, kGain = kMaxForce - 1;
  if (velocity <= -1) return 0;
  if (velocity <= 0) return (1 + velocity) * (1 + velocity);
  if (velocity < kGain) return kMaxForce - (kGain - velocity) * (kGain - velocity) / kGain;
  return kMaxForce;
}

TendonForces ForcesOf(const MuscleParameters& muscle, const Fibre& fibre) {
  if (fibre.length == 0) return {};
  const double full = muscle.max_force * fibre.cos_pennation;
  return {full * ActiveForceLength(fibre.length) * ForceVelocity(fibre.velocity),
          full * PassiveForceLength(fibre.length)};
}

}  // namespace predictor::muscles
