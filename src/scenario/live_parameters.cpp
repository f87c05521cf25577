#include "scenario/live_parameters.h"

#include <algorithm>

#include "scenario/operating_rules.h"

namespace predictor {
namespace {

constexpr double kLeastForce = 5;     // with a lower threshold, a hand's own weight and noise would
                                      // stop a run [N]
constexpr double kLeastTorque = 0.5;  // [N·m]

}  // namespace

ParameterRange RangeOf(const Scenario& scenario, Parameter parameter) {
  const bool may_stiffen = RulesFor(scenario).may_stiffen;
  switch (parameter) {
    case Parameter::kStiffnessTranslation:
    case Parameter::kStiffnessRotation:
      return {0.2, may_stiffen ? 2.0 : 1.0, 1};
    case Parameter::kDampingRatio:
      return {may_stiffen ? 0.5 : 1.0, 2, 1};
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
