// A run up to the tick in which a limit of the emulator stopped it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/record.h"
#include "recording/reader.h"
#include "scenario/scenario.h"

namespace predictor {

struct StoppedRun {
  Scenario scenario;
  std::vector<std::byte> state;  // state of the emulator before the tick in which the stop was
                                 // decided
  std::vector<TickRecord> past;  // the ticks of the last kPastTime of RUN; the stop was decided in
                                 // the last one
  TickRecord first{};            // the first tick of RUN
  double peak_before = 0;        // largest force of a hand before the tick of the stop [N]

  const TickRecord& stop() const { return past.back(); }
};

inline constexpr double kPastTime = 0.5;  // [s]

// Receives the ticks of a run, and finds the tick in which the first stop by a limit (IsLimit) was
// decided.
class StopFinder {
 public:
  explicit StopFinder(double rate);
  // Adds the next record. The records must be added in order. Returns true if the stop was decided
  // in the tick of this record. Later records are ignored.
  bool Add(const TickRecord& record);
  bool found() const { return found_; }
  // Returns the first other cause that stopped the run, or kNone if no other cause stopped it.
  StopCause other() const { return other_; }
  const std::vector<TickRecord>& past() const { return past_; }
  double peak_before() const { return peak_; }  // [N]
  const TickRecord& first() const { return first_; }

 private:
  std::size_t most_;  // maximum number of records in past_
  std::vector<TickRecord> past_;
  TickRecord first_{};
  double peak_ = 0;
  StopCause cause_ = StopCause::kNone, other_ = StopCause::kNone;
  bool found_ = false;
};

// Finds the stop in a recording, and computes the run up to the stop again from the last saved
// state (or from the start). `scenario` comes from RestoreScenario. The function `progress`
// receives the number of ticks that have been computed so far. Throws InputError if there is no
// stop by a limit, if ticks before the stop are lost, if the computed run differs from the recorded
// run, or if the run cannot be continued.
StoppedRun FindStop(RecordingReader* reader, const Scenario& scenario,
                    const std::function<void(std::uint64_t)>& progress);

// Throws InputError if a run of this scenario cannot be continued.
void CheckContinuable(const Scenario& scenario);

}  // namespace predictor
