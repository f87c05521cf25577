// A recording read back: tick by tick, from any tick on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/record.h"
#include "recording/header.h"

namespace predictor {

struct RecordedSnapshot {
  std::uint64_t tick = 0;  // after which the state was so
  std::vector<std::byte> bytes;
};

// Everything that is read is checked against its CRC: what cannot be trusted throws InputError
// that names the place, and is never given out. Memory is bounded whatever the file says.
class RecordingReader {
 public:
  // Throws InputError if it is no recording, one of another version, or damaged in both places
  // where it says what it is.
  explicit RecordingReader(const std::string& path);
  ~RecordingReader();
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  const RecordingHeader& header() const;
  // It was closed: its index is there and right. Else it was cut (or its index is damaged), and is
  // read to its last whole chunk.
  bool complete() const;
  // In sentences for a person: that it is not complete, what of its header was read from the second
  // place, and what of it is lost. Empty: nothing is wrong so far.
  const std::string& problem() const;
  std::uint64_t bytes() const;  // of the file

  // How many ticks; of a cut recording by reading it. Throws InputError.
  std::uint64_t count();
  // The next tick; false behind the last. Throws InputError.
  bool Next(TickRecord* record);
  // Next() goes on with the first tick that is `tick` or later. Throws InputError.
  void Seek(std::uint64_t tick);

  // Which ticks have snapshots, in their order. Throws InputError.
  const std::vector<std::uint64_t>& snapshots();
  // The newest of `tick` or before; false if there is none. Throws InputError.
  bool SnapshotAt(std::uint64_t tick, RecordedSnapshot* snapshot);

  // In their order, the first 200 000 at most. Throws InputError.
  const std::vector<RecordingEvent>& events();
  std::uint64_t more_events();  // that are in the file beside them
  // Those that tell of lost ticks.
  std::vector<RecordingEvent> gaps();

  // Reads the whole file and compares all that can be compared: the CRC of everything, each chunk,
  // each message against its index. Throws InputError at the first fault.
  void Check();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
