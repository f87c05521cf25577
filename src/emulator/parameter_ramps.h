// Parameters that people move while a run is on: they arrive in a second, never at once.
#pragma once

#include <array>

#include "scenario/live_parameters.h"

namespace predictor {

class ParameterRamps {
 public:
  static constexpr double kRampTime = 1.0;  // [s]

  explicit ParameterRamps(const Scenario& scenario) : keeps_thresholds_(scenario.HasRealArms()) {
    for (int k = 0; k < kParameters; ++k) {
      range_[k] = RangeOf(scenario, static_cast<Parameter>(k));
      value_[k] = goal_[k] = range_[k].start;
      rate_[k] = 0;
    }
  }

  // Begins to move one to `value`. False, and nothing changes, if it is not a number in range.
  bool Set(Parameter parameter, double value) noexcept {
    const int k = static_cast<int>(parameter);
    if (k < 0 || k >= kParameters) return false;
    if (!(value >= range_[k].min && value <= range_[k].max)) return false;
    goal_[k] = value;
    rate_[k] = (value - value_[k]) / kRampTime;
    return true;
  }

  // dt [s] later. True if anything moved.
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

  // To the scenario's values. With real arms thresholds that somebody made tighter stay so: what
  // protects a person is loosened by a person's decision alone, never as a reset's by-product.
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
