// Tries a controller on recorded states to find out whether it allocates memory, and how long its
// steps take.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

struct TrialFigures {
  static constexpr double kMaxCpuTime = 3e-4;  // of the longest step [s]
  static constexpr double kMaxTime = 2e-4;     // of 99 % of the steps, by the clock [s]

  std::uint64_t steps = 0;
  std::uint64_t allocating = 0;  // steps with a heap allocation
  double first_allocation = 0;   // its simulated time [s]
  std::uint64_t not_finite = 0;  // steps without usable torques
  double median = 0, p99 = 0;    // time of a step by the clock [s]
  double longest_cpu = 0;        // [s]

  bool passed() const {
    return steps > 0 && allocating == 0 && not_finite == 0 && p99 <= kMaxTime &&
           longest_cpu <= kMaxCpuTime;
  }
};

class ControllerTrial {
 public:
  // Makes the scenario's controller. From the construction on, the trial counts the allocations of
  // this process. Throws InputError.
  explicit ControllerTrial(const Scenario& scenario);
  ~ControllerTrial();

  int dof() const;
  // Performs one step of the controller at a recorded state [s, rad, rad/s].
  void Step(double time, const JointVector& q, const JointVector& v);
  TrialFigures Figures() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
