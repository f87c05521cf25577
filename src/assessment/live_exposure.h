// Damage and fatigue of a run that is not over.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "assessment/exposure.h"
#include "assessment/frame.h"
#include "core/person_state.h"

namespace predictor::assessment {

// Damage so far is that of DamageOfMoment for the samples so far, as if the run ended now with
// rest.
class LiveExposure {
 public:
  explicit LiveExposure(const Scenario& scenario);
  // The next sample; null: no hand holds a handle, so the arms rest.
  void Add(const Frame* frame);
  // Writes damage and capacity into `state`. The damage is computed again when the samples have
  // grown by a fiftieth and by 1 s, which bounds the cost; with `now`, at once.
  void Write(bool now, PersonState* state);

 private:
  struct Part {
    std::optional<FatigueTracker> fatigue;
    double (*damage_per_cycle)(double) = nullptr;  // null: no tool
    const ergonomics::DamageRisk* risk = nullptr;
    std::vector<double> moment;  // [N·m]
    DamageResult damage;
  };

  std::array<Part, kBodyParts> parts_;
  std::size_t count_ = 0, counted_ = 0;  // samples, and those in the damage
};

}  // namespace predictor::assessment
