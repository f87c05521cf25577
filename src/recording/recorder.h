// A recording of a run in real time: behind the ring of records, in threads of its own.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "recording/disk_rules.h"
#include "recording/file_calls.h"
#include "recording/header.h"

namespace predictor {

struct RecorderStatus {
  bool recording = true;
  std::string ended_why;    // a full sentence; empty while it records, or if it was asked to end
  std::uint64_t bytes = 0;  // on the disk
  std::uint64_t ticks = 0;  // in whole chunks on the disk
  std::uint64_t lost = 0;   // ticks that were overwritten before they could be read
  std::uint64_t free_bytes = 0;  // on the disk, at the last look
};

struct RecorderOptions : DiskRules {
  std::chrono::milliseconds snapshot_period{10'000};
  std::size_t snapshot_bytes = 1U << 20U;  // no snapshot is larger
  std::size_t most_queued = 64U << 20U;    // of chunks that wait for the disk [bytes]
};

// One thread reads the ring, encodes and compresses; one writes; one asks the disk to make it last.
// So a slow disk delays the second and third, and the first only after `most_queued`.
class Recorder {
 public:
  // Records what is published from now on; `ring` and `calls` are borrowed. Throws InputError if
  // the file is there already or cannot be made.
  Recorder(const std::string& path, const RecordingHeader& header, const RecordRing& ring,
           RecorderOptions options = {}, std::vector<JsonChannel> scene = {},
           FileCalls* calls = nullptr);
  ~Recorder();  // closes
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // For the thread that ticks; wait-free. If a snapshot of the complete state is wanted: where to
  // put it; else nothing. Then SnapshotTaken says after which tick it was taken, and how long it
  // became (0: it could not be taken).
  std::span<std::byte> SnapshotBuffer() noexcept;
  void SnapshotTaken(std::uint64_t tick, std::size_t bytes) noexcept;

  // Something that happened, beside the newest tick. From any thread but the one that ticks.
  void Mark(const std::string& text);
  RecorderStatus status() const;  // "

  // Takes what is in the ring, ends the file. Blocks until the disk has it.
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
