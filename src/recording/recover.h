// Repairs a truncated or damaged recording and writes the result to a new file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "recording/file_calls.h"
#include "recording/header.h"

namespace predictor {

struct RecoverReport {
  bool was_complete = false;         // the recording had no damage
  std::uint64_t ticks = 0;           // number of ticks kept
  std::uint64_t chunks = 0;          // number of complete chunks kept
  std::uint64_t damaged_chunks = 0;  // number of damaged chunks, including truncated ones
  std::uint64_t salvaged_ticks = 0;  // number of `ticks` that come from damaged chunks
  std::uint64_t lost_ticks = 0;  // ticks lost between kept ones; the number after the last kept one
                                 // is unknown
  std::uint64_t snapshots = 0, events = 0;  // numbers of those kept
  std::uint64_t left_out_markers = 0, left_out_states = 0, left_out_heads = 0,
                left_out_samples = 0;  // omitted, see Rewriting
  std::uint64_t gave_up_at = 0;        // byte at which the search was abandoned; 0: not abandoned
  std::string preamble;  // sentences about repaired or lost parts of the preamble; empty: none

  std::string Text() const;  // Sentences for the user.
};

// The changes that are made in the copy of a recording.
struct Rewriting {
  std::function<void(RecordingHeader*)> change;  // changes the header; may throw; empty: no change
  bool person = true;  // keep events with free text, and the states of the person
};

// Writes all intact parts of `in` to `out`, with a new index. Only ticks with a valid CRC are taken
// from a damaged chunk. `in` is not changed. Throws InputError if `in` is not a recording or is
// damaged before its first tick, or if `out` exists. Throws RecordingError if `out` cannot be
// written. `calls` is borrowed.
RecoverReport Recover(const std::string& in, const std::string& out, FileCalls* calls = nullptr,
                      const Rewriting& rewriting = {});

}  // namespace predictor
