// Records a run in real time from the ring of records, in separate threads.
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
  std::string ended_why;    // full sentence; empty while recording, or if the end was requested
  std::uint64_t bytes = 0;  // bytes on the disk
  std::uint64_t ticks = 0;  // ticks in complete chunks on the disk
  std::uint64_t lost = 0;   // ticks that were overwritten before they could be read
  std::uint64_t free_bytes = 0;  // free space on the disk at the last check
};

struct RecorderOptions : DiskRules {
  std::chrono::milliseconds snapshot_period{10'000};
  std::size_t snapshot_bytes = 1U << 20U;  // maximum size of a snapshot
  std::size_t max_queued = 64U << 20U;     // maximum size of the chunks that wait for the disk
                                           // [bytes]
  const EvaluationBoard* person =
      nullptr;                      // source of the person's states to record; null: none; borrowed
  const HeadRing* heads = nullptr;  // source of the measured heads to record; null: none; borrowed
  const StreamRing* samples = nullptr;  // source of the samples of other systems; null: none;
                                        // borrowed
  std::vector<std::string> streams;     // descriptions of their streams, each a JSON object
};

// The first thread reads the ring, encodes and compresses. The second thread writes, and the third
// thread synchronises the disk. A slow disk therefore delays the second and the third thread. A
// slow disk delays the first thread only when `max_queued` is reached.
class Recorder {
 public:
  // Records everything that is published from now on. `ring` and `calls` must outlive this object.
  // Throws InputError if the file exists or cannot be created.
  Recorder(const std::string& path, const RecordingHeader& header, const RecordRing& ring,
           RecorderOptions options = {}, std::vector<JsonChannel> scene = {},
           FileCalls* calls = nullptr);
  ~Recorder();  // closes the recording
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // The following functions are wait-free, and only the thread of the control loop may call them.
  // SnapshotBuffer returns its buffer if a snapshot of the complete state is wanted, and otherwise
  // returns an empty span. SnapshotTaken then reports the size of the snapshot and the tick after
  // which the snapshot was taken. The size is 0 if the snapshot could not be taken.
  std::span<std::byte> SnapshotBuffer() noexcept;
  void SnapshotTaken(std::uint64_t tick, std::size_t bytes) noexcept;

  // Records an event at the newest tick. Any thread except that of the control loop may call this
  // function.
  void Mark(const std::string& text);
  RecorderStatus status() const;  // may be called from the same threads as Mark

  // Records all remaining data of the ring and ends the file. Blocks until all data are on the
  // disk.
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
