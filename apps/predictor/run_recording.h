// The recording of a run in real time.
#pragma once

#include <string>

#include "core/shared_run.h"
#include "emulator/run_loop.h"
#include "recorded_run.h"
#include "recording/recorder.h"

namespace predictor {

class RunRecording final : public StateSink {
 public:
  // Records to `options.file`, or where NewRecordingName says, what is published into the board
  // from now on; says on the board whether it does. The board is borrowed. Throws InputError.
  RunRecording(const Emulator& emulator, const RecordOptions& options, RunBoard* board);

  std::span<std::byte> Wanted() noexcept override { return recorder_.SnapshotBuffer(); }
  void Taken(std::uint64_t tick, std::size_t bytes) noexcept override {
    recorder_.SnapshotTaken(tick, bytes);
  }
  // Once in a while, not from the thread that ticks: keeps the board's word true.
  void Look();
  // A marker, for whoever looks at the recording.
  void Mark(const std::string& text) { recorder_.Mark(text); }
  // Ends it, and tells what became of it unless quiet. Returns whether it went on to the end.
  bool Close(bool quiet);

 private:
  RunBoard* board_;
  std::string file_;
  Recorder recorder_;
};

}  // namespace predictor
