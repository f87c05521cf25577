// Reads a recording tick by tick, starting at any tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/head_record.h"
#include "core/record.h"
#include "recording/header.h"

namespace predictor {

struct RecordedHead {
  double time = 0;  // since the start of the recording [s]
  HeadRecord head;  // without wall_ns and client
};

struct RecordedSnapshot {
  std::uint64_t tick = 0;  // tick after which the state was saved
  std::vector<std::byte> bytes;
};

// Compares all data with their CRC. Data that cannot be trusted are never returned. Instead of such
// data, the reader throws an InputError that states their position. The memory use is limited,
// whatever sizes the file claims.
class RecordingReader {
 public:
  // Throws InputError if the file is not a recording, has another version, or its description is
  // damaged in both places.
  explicit RecordingReader(const std::string& path);
  ~RecordingReader();
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  const RecordingHeader& header() const;
  // Returns whether the recording was closed, so that its index exists and is valid. A recording
  // that was not closed is truncated, or its index is damaged. Such a recording is read up to its
  // last complete chunk.
  bool complete() const;
  // Returns sentences for the user. They state whether the recording is incomplete, which parts of
  // its header were read from the copy, and which parts are lost. The text is empty if there has
  // been no problem so far.
  const std::string& problem() const;
  std::uint64_t bytes() const;  // size of the file

  // Returns the number of ticks. If the recording is truncated, this function reads the whole
  // recording. Throws InputError.
  std::uint64_t count();
  // Reads the next tick. Returns false after the last tick. Throws InputError.
  bool Next(TickRecord* record);
  // Makes Next() continue with the first tick at or after `tick`. Throws InputError.
  void Seek(std::uint64_t tick);

  // Returns the ticks with snapshots in ascending order. Throws InputError.
  const std::vector<std::uint64_t>& snapshots();
  // Reads the newest snapshot at or before `tick`. Returns false if there is no such snapshot.
  // Throws InputError.
  bool SnapshotAt(std::uint64_t tick, RecordedSnapshot* snapshot);

  // Returns the events in order, at most the first 200 000. Throws InputError.
  const std::vector<RecordingEvent>& events();
  std::uint64_t more_events();  // number of further events in the file
  // Returns the events about lost ticks.
  std::vector<RecordingEvent> gaps();

  // Reads the measured poses of the head, in the order of their times. Returns none if the
  // recording has no such stream. Throws InputError.
  std::vector<RecordedHead> ReadHeads() const;

  // Reads the streams that other systems sent, up to a limit of the memory. Returns none if the
  // recording has none. Throws InputError.
  std::vector<RecordedStream> ReadStreams() const;

  // Reads the whole file and verifies the CRC of the file, each chunk, and each message against its
  // index. Throws InputError at the first error.
  void Check();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
