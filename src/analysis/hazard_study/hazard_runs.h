// Simulates runs that differ only in their random numbers and in what follows from these numbers.
// All runs continue from the same saved state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/status.h"
#include "emulator/emulator.h"
#include "scenario/scenario.h"

namespace predictor {

// One run of the study, which has its own seed.
struct HazardRun {
  std::uint64_t seed = 0;
  double begin = -1;             // run time at which the hazard began [s]; −1: it did not begin
  double before = 0, after = 0;  // largest force of a hand before and after the hazard began [N]
  double torque = 0, speed = 0;  // largest values after the hazard began [N·m], [m/s]
  double until_stop = -1;  // from the beginning of the hazard to the emulator's stop [s]; −1:
                           // no stop
  StopCause cause = StopCause::kNone;
  double detection = -1;  // from the time at which the true force crosses its threshold to the stop
                          // [s]
  double excess = -1;     // of the true force over its threshold at that stop [N]
  // Time from the moment at which the true force clearly exceeds its threshold (ClearCrossing) to
  // the stop [s]; −1 if the force did not clearly exceed the threshold.
  double clear_detection = -1;
  // The largest commanded speed of a handle, as a share of its cap (CommandedSpeeds).
  double commanded = 0;
  double travel = -1;  // travel of the faster handle during the stop [m]
  CobotStop cobot_stop = CobotStop::kNone;
};

class HazardObserver;

class HazardRuns {
 public:
  // The first event of the scenario is the hazard. Simulates the common beginning of the runs,
  // which ends one tick before the hazard can begin, and saves the state. Throws InputError.
  explicit HazardRuns(const Scenario& scenario);
  ~HazardRuns();

  // Continues from the saved state until the end of the scenario's duration. `seed` determines the
  // random numbers from the saved state on. If the common beginning ended in a stop, every run
  // consists of the common beginning only.
  HazardRun Run(std::uint64_t seed);

 private:
  Emulator emulator_;
  std::unique_ptr<const HazardObserver> beginning_;  // has observed the common beginning
  std::vector<std::byte> state_;
};

}  // namespace predictor
