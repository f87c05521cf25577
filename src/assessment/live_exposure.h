// Damage and fatigue of a run in progress.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "assessment/exposure.h"
#include "assessment/frame.h"
#include "core/person_state.h"

namespace predictor::assessment {

// The damage is the result of DamageOfMoment for the samples so far, as if the run ended now at
// rest.
class LiveExposure {
 public:
  explicit LiveExposure(const Scenario& scenario);
  // Adds the next sample. A null `frame` means that no hand holds a handle, so the arms rest.
  void Add(const Frame* frame);
  // Writes damage and capacity into `state`. To limit the computing time, the damage is computed
  // again only when the samples have grown by 2 % and by at least 1 s. If `now` is true, the damage
  // is computed immediately.
  void Write(bool now, PersonState* state);

 private:
  // Fills the gaps of a load as WithoutGaps does, except at the start, where the load is 0.
  class Gaps {
   public:
    // Returns the load of a sample in which a hand holds a handle.
    double Fill(double load);
    // Returns whether more than kMaxUnknownShare of the loads are unknown.
    bool TooLong() const;

   private:
    double last_ = 0;
    std::size_t count_ = 0, unknown_ = 0;
  };
  struct Part {
    std::optional<FatigueTracker> fatigue;
    const ergonomics::DamageTool* tool = nullptr;  // null if there is no tool
    std::vector<double> moment;                    // [N·m]
    DamageResult damage;
    Gaps moment_gaps, fatigue_gaps;
  };

  std::array<Part, kBodyParts> parts_;
  std::size_t count_ = 0, counted_ = 0;  // number of samples, and of those included in the damage
};

}  // namespace predictor::assessment
