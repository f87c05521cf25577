#include "scenario/live_parameters.h"

#include <algorithm>

namespace predictor {
namespace {

constexpr double kLeastForce = 5;     // below it a hand's own weight and noise would stop a run [N]
constexpr double kLeastTorque = 0.5;  // [N·m]

}  // namespace

ParameterRange RangeOf(const Scenario& scenario, Parameter parameter) {
  const bool real = scenario.HasRealArms();
  switch (parameter) {
    case Parameter::kStiffnessTranslation:
    case Parameter::kStiffnessRotation:
      return {0.2, real ? 1.0 : 2.0, 1};
    case Parameter::kDampingRatio:
      return {real ? 1.0 : 0.5, 2, 1};
    case Parameter::kForceThreshold:
      return {std::min(kLeastForce, scenario.safety.force), scenario.safety.force,
              scenario.safety.force};
    case Parameter::kTorqueThreshold:
      return {std::min(kLeastTorque, scenario.safety.torque), scenario.safety.torque,
              scenario.safety.torque};
  }
  return {};
}

}  // namespace predictor
