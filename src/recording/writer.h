// Writes a recording in the calling thread, for virtual time. Use the Recorder for real time.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/record.h"
#include "recording/disk_rules.h"
#include "recording/file_calls.h"
#include "recording/header.h"

namespace predictor {

// A recording ended early because the disk is full, the disk is nearly full, or writing failed. The
// text of what() gives the reason and the amount of data kept, and states that the file can be read
// up to there.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The first failure makes Add, AddSnapshot, AddEvent, NoteLoss or Close throw RecordingError once.
// The file is then closed, and further data are ignored. The destructor closes the file without
// reporting errors.
class RecordingWriter {
 public:
  // Throws InputError if the file exists or cannot be created. `calls` is borrowed. If no rules are
  // given, the recording may fill the disk completely.
  RecordingWriter(const std::string& path, const RecordingHeader& header,
                  std::vector<JsonChannel> scene = {}, FileCalls* calls = nullptr,
                  const DiskRules& rules = {.warn_below = 0, .end_below = 0});
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  void Add(const TickRecord& record);
  // Adds the complete state after `tick` as opaque bytes. Throws std::invalid_argument for more
  // than 32 MiB.
  void AddSnapshot(std::uint64_t tick, std::span<const std::byte> bytes);
  void AddEvent(const std::string& text, std::uint64_t tick);
  // Records that `count` ticks before `tick` are missing.
  void NoteLoss(std::uint64_t count, std::uint64_t tick);
  // Ends the file with its index.
  void Close();

  std::uint64_t bytes() const;  // size on the disk
  std::uint64_t ticks() const;  // number on the disk

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
