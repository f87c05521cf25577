// Determines when the virtual cobot's controller computes, and when its torques act.
#pragma once

#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// Applies a zero-order hold and a delay to the torques, in sub-steps of the simulation.
class ControlTiming {
 public:
  // `step` is the duration of a sub-step [s]. `max_added` is the largest delay that AddDelay adds
  // [s]. Throws InputError if period or delay is not a whole number of sub-steps.
  ControlTiming(const ControlSpec& spec, double step, double max_added = 0);

  // The following functions return the controller's period [sub-steps, s] and the delay of its
  // torques [sub-steps].
  int period() const noexcept { return period_; }
  double period_time() const noexcept { return period_ * step_; }
  int delay() const noexcept { return delay_; }
  bool is_immediate() const noexcept { return period_ == 1 && past_.size() == 1; }
  // Returns the mean time from the state at which torques are computed until they act [s], in
  // addition to the hold of one sub-step.
  double mean_delay() const noexcept { return (delay_ + 0.5 * (period_ - 1)) * step_; }

  // Resets the state as if `torque` had been applied for a long time [N·m].
  void Reset(const JointVector& torque) noexcept;
  // Delays the torques further by `time` [s], to the nearest sub-step, but at most by max_added.
  void AddDelay(double time) noexcept;
  // Returns whether the controller computes in this sub-step.
  bool is_due() const noexcept { return count_ % static_cast<std::uint32_t>(period_) == 0; }
  // Call this function once per sub-step with the torque that was computed last. Returns the torque
  // that acts.
  const JointVector& Apply(const JointVector& torque) noexcept;

  void Archive(StateArchive& a) noexcept {
    if (!is_immediate()) a(count_, past_);
  }

 private:
  double step_;
  int period_, delay_;
  int added_ = 0;                  // to the delay [sub-steps]
  std::uint32_t count_ = 0;        // sub-steps since Reset
  std::vector<JointVector> past_;  // torques of the last sub-steps, by their number modulo its size
};

}  // namespace predictor
