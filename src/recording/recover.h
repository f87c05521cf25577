// A recording that was cut or damaged, mended into a new one.
#pragma once

#include <cstdint>
#include <string>

#include "recording/file_calls.h"

namespace predictor {

struct RecoverReport {
  bool was_complete = false;         // nothing was wrong with it
  std::uint64_t ticks = 0;           // kept
  std::uint64_t chunks = 0;          // kept whole
  std::uint64_t damaged_chunks = 0;  // cut ones are among them
  std::uint64_t salvaged_ticks = 0;  // of `ticks`: out of damaged chunks
  std::uint64_t lost_ticks = 0;      // between those that were kept; behind the last, nobody knows
  std::uint64_t snapshots = 0, events = 0;  // kept
  std::uint64_t gave_up_at = 0;             // byte from which on nothing was looked for; 0: none
  std::string preamble;  // what of it was mended or is lost, in sentences; empty: nothing

  std::string Text() const;  // sentences for a person
};

// Writes to `out` all that is whole in `in`, with a new index. A damaged chunk gives those of its
// ticks whose own CRC is right. Only reads `in`. Throws InputError if `in` is no recording or
// damaged before its first tick, or `out` exists, and RecordingError if `out` cannot be written;
// `calls` is borrowed.
RecoverReport Recover(const std::string& in, const std::string& out, FileCalls* calls = nullptr);

}  // namespace predictor
