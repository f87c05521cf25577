// A recording made once more: the run is computed again from what was put into it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/record.h"
#include "recording/reader.h"
#include "scenario/scenario.h"

namespace predictor {

// Where the run computed again is no longer the recorded one.
struct Departure {
  std::uint64_t tick = 0;
  double run_time = 0;  // [s]
  std::string field;    // the first in the order of the record
  std::string recorded, computed;
};

struct Verification {
  std::uint64_t ticks = 0;    // compared, bit for bit
  std::uint64_t missing = 0;  // ticks that the recording lost
  std::uint64_t skipped = 0;  // there, but before the first state after a gap
  std::optional<Departure> departure;
};

// Computes the run again, from the start, and after ticks that were lost from the next saved state.
// Of real arms, each tick is given what they and their sensors gave then; all else is computed, but
// for the warnings of what their wires lost.
// Stops at the first departure. `scenario`: as RestoreScenario gives it. progress: ticks so far.
// Throws InputError if the recording cannot be read.
Verification Verify(RecordingReader* reader, const Scenario& scenario,
                    const std::function<void(std::uint64_t)>& progress);

// First field in which two records of the same tick differ, wall-clock times apart; none if they
// agree bit for bit.
std::optional<Departure> FirstDifference(const TickRecord& recorded, const TickRecord& computed);

}  // namespace predictor
