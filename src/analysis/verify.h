// Replays a recording by computing the run again from the recorded inputs.
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

// The first difference between the replay and the recording.
struct Departure {
  std::uint64_t tick = 0;
  double run_time = 0;  // [s]
  std::string field;    // first differing field in the order of the record
  std::string recorded, computed;
};

struct Verification {
  std::uint64_t ticks = 0;    // number of ticks compared bit for bit
  std::uint64_t missing = 0;  // number of ticks that the recording lost
  std::uint64_t skipped = 0;  // ticks that exist but precede the first saved state after a gap
  std::optional<Departure> departure;
};

// Computes the run again from the start and, after lost ticks, from the next saved state. With real
// arms, each tick receives the recorded samples of arms and sensors. Everything else is computed,
// except the warnings about losses on the connections to the arms. Stops at the first difference.
// `scenario` comes from RestoreScenario. The function `progress` receives the number of ticks that
// have been computed so far. Throws InputError if the recording cannot be read.
Verification Verify(RecordingReader* reader, const Scenario& scenario,
                    const std::function<void(std::uint64_t)>& progress);

// Returns the first field in which two records of the same tick differ, or no value if the records
// agree bit for bit. Wall-clock times are not compared.
std::optional<Departure> FirstDifference(const TickRecord& recorded, const TickRecord& computed);

}  // namespace predictor
