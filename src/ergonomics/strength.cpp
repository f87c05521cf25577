#include "ergonomics/strength.h"

#include <algorithm>
#include <cmath>

#include "core/normal.h"
#include "core/units.h"

namespace predictor::ergonomics {

double MeanStrength(StrengthDirection direction, Sex sex, double elbow, double shoulder) {
  const bool male = sex == Sex::kMale;
  const double e = elbow * kDegrees, s = shoulder * kDegrees;
  double strength = 0;
  switch (direction) {
    case StrengthDirection::kElbowFlexion:
      strength = (336.29 + 1.544 * e - 0.0085 * e * e - 0.5 * s) * (male ? 0.1913 : 0.1005);
      break;
    case StrengthDirection::kElbowExtension:
      strength = (264.153 + 0.575 * e - 0.425 * s) * (male ? 0.2126 : 0.1153);
      break;
    case StrengthDirection::kShoulderFlexion:
      strength = (227.338 + 0.525 * e - 0.296 * s) * (male ? 0.2845 : 0.1495);
      break;
    case StrengthDirection::kShoulderExtension:
      strength = (204.562 + 0.099 * s) * (male ? 0.4957 : 0.2485);
      break;
  }
  return std::max(0.0, strength);
}

double ShareCapable(double torque, double mean_strength) {
  if (mean_strength <= 0) return torque <= 0 ? 1 : 0;
  return NormalProbability((1 - torque / mean_strength) / kStrengthVariation);
}

StrengthShares SampleStrength(RandomStream* random) {
  const double common = std::sqrt(kStrengthCorrelation) * random->Normal();
  const double own = std::sqrt(1 - kStrengthCorrelation);
  StrengthShares shares;
  for (double& share : shares)
    share = std::max(kMinStrengthShare, 1 + kStrengthVariation * (common + own * random->Normal()));
  return shares;
}

}  // namespace predictor::ergonomics
