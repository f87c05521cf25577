// Holds the parameters that people change during a run. Each parameter ramps to its new value
// within one second.
#pragma once

#include <array>

#include "scenario/operating_rules.h"

namespace predictor {

class ParameterRamps {
 public:
  static constexpr double kRampTime = 1.0;  // [s]

  explicit ParameterRamps(const Scenario& scenario)
      : keeps_thresholds_(RulesFor(scenario).keeps_tightened_thresholds) {
    for (int k = 0; k < kParameters; ++k) {
      range_[k] = RangeOf(scenario, static_cast<Parameter>(k));
      value_[k] = goal_[k] = range_[k].start;
      rate_[k] = 0;
    }
  }

  // Starts a parameter's ramp to `value`. If the value is out of range, the function returns false
  // and changes nothing.
  bool Set(Parameter parameter, double value) noexcept {
    const int k = static_cast<int>(parameter);
    if (k < 0 || k >= kParameters) return false;
    if (!(value >= range_[k].min && value <= range_[k].max)) return false;
    goal_[k] = value;
    rate_[k] = (value - value_[k]) / kRampTime;
    return true;
  }

  // Advances the ramps by dt [s]. Returns whether a parameter changed.
  bool Step(double dt) noexcept {
    bool moved = false;
    for (int k = 0; k < kParameters; ++k) {
      if (value_[k] == goal_[k]) continue;
      moved = true;
      const double next = value_[k] + rate_[k] * dt;
      const bool arrived = rate_[k] > 0 ? next >= goal_[k] : next <= goal_[k];
      value_[k] = arrived ? goal_[k] : next;
    }
    return moved;
  }

  // Restores the scenario's values. If the rules require it, a reset keeps thresholds that were
  // tightened, because only a person may decide to loosen them.
  void Reset() noexcept {
    for (int k = 0; k < kParameters; ++k) {
      const auto parameter = static_cast<Parameter>(k);
      const bool threshold =
          parameter == Parameter::kForceThreshold || parameter == Parameter::kTorqueThreshold;
      if (!keeps_thresholds_ || !threshold) goal_[k] = range_[k].start;
      value_[k] = goal_[k];
      rate_[k] = 0;
    }
  }

  template <class A>
  void Archive(A& a) noexcept {
    a(value_, goal_, rate_);
  }

  double operator[](Parameter parameter) const noexcept {
    return value_[static_cast<int>(parameter)];
  }
  const double* values() const noexcept { return value_; }

 private:
  bool keeps_thresholds_;
  std::array<ParameterRange, kParameters> range_;
  double value_[kParameters], goal_[kParameters], rate_[kParameters];
};

}  // namespace predictor
