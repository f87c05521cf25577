#include "scenario/operating_rules.h"

#include <algorithm>

namespace predictor {
namespace {

constexpr double kMinForce = 5;     // with a lower threshold, a hand's own weight and noise would
                                    // stop a run [N]
constexpr double kMinTorque = 0.5;  // [N·m]
constexpr double kMaxRealHandleSpeed = 0.5;  // [m/s]

}  // namespace

OperatingRules RulesFor(const Scenario& scenario) {
  OperatingRules rules;
  if (!scenario.HasRealArms()) {
    rules.handle_gravity = scenario.environment.gravity;
    return rules;
  }
  rules.auto_start = false;
  rules.remote_start = false;
  rules.may_switch_scenario = false;
  rules.needs_enabling = true;
  rules.needs_person = true;
  rules.aligns_hands_free = true;
  rules.rechecks_alignment = true;
  rules.keeps_tightened_thresholds = true;
  rules.may_stiffen = false;
  rules.watches_headsets = true;
  rules.single_use_access_code = true;
  rules.external_device = true;
  rules.arms_move_between_ticks = true;
  rules.cuts_power_of_moving_arms = true;
  rules.needs_repairs = true;
  rules.distrusts_libraries = true;
  rules.always_separates_elbows = true;
  rules.max_handle_speed = kMaxRealHandleSpeed;
  rules.sensors_always_have_noise = true;
  rules.detects_runaway = true;
  rules.handle_gravity = kStandardGravity;  // even if the scenario's world has another gravity
  return rules;
}

ParameterRange RangeOf(const Scenario& scenario, Parameter parameter) {
  const bool may_stiffen = RulesFor(scenario).may_stiffen;
  switch (parameter) {
    case Parameter::kStiffnessTranslation:
    case Parameter::kStiffnessRotation:
      return {0.2, may_stiffen ? 2.0 : 1.0, 1};
    case Parameter::kDampingRatio:
      return {may_stiffen ? 0.5 : 1.0, 2, 1};
    case Parameter::kForceThreshold:
      return {std::min(kMinForce, scenario.safety.force), scenario.safety.force,
              scenario.safety.force};
    case Parameter::kTorqueThreshold:
      return {std::min(kMinTorque, scenario.safety.torque), scenario.safety.torque,
              scenario.safety.torque};
  }
  return {};
}

}  // namespace predictor
