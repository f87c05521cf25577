// The recording of a run in real time.
#pragma once

#include <string>

#include "core/shared_run.h"
#include "emulator/run_loop.h"
#include "recorded_run.h"
#include "recording/recorder.h"

namespace predictor {

class RunRecording final : public SnapshotSink {
 public:
  // Records everything that is published on the board from now on to `options.file`, or to the file
  // of NewRecordingName. Shows on the board whether it is recording. The board is borrowed. Throws
  // InputError.
  RunRecording(const Emulator& emulator, const RecordOptions& options, RunBoard* board);

  std::span<std::byte> AcquireBuffer() noexcept override { return recorder_.SnapshotBuffer(); }
  void Commit(std::uint64_t tick, std::size_t bytes) noexcept override {
    recorder_.SnapshotTaken(tick, bytes);
  }
  // Call regularly, but not in the tick's thread: updates the board's recording state.
  void Look();
  // Adds a marker for people who evaluate the recording.
  void Mark(const std::string& text) { recorder_.Mark(text); }
  // Ends the recording and prints its result unless quiet. Returns whether it recorded until the
  // end.
  bool Close(bool quiet);
  const std::string& file() const { return file_; }

 private:
  RunBoard* board_;
  std::string file_;
  Recorder recorder_;
};

}  // namespace predictor
