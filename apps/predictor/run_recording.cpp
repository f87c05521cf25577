#include "run_recording.h"

#include "core/format.h"
#include "recording/scene.h"
#include "screen.h"

namespace predictor {
namespace {

RecorderOptions Options() {
  RecorderOptions options;
  options.snapshot_bytes = kStateBytes;
  options.tell = [](const std::string& text) { TheScreen().Tell(text); };
  return options;
}

}  // namespace

RunRecording::RunRecording(const Emulator& emulator, const RecordOptions& options, RunBoard* board)
    : board_(board),
      file_(options.file.empty() ? NewRecordingName(emulator.scenario()) : options.file),
      recorder_(file_, HeaderOf(emulator, options), board->records, Options(),
                RecordedScene(emulator.scenario(), emulator.setup().object_start)) {
  Look();
}

void RunRecording::Look() {
  board_->recording.store(recorder_.status().recording ? 1 : 0, std::memory_order_relaxed);
}

bool RunRecording::Close(bool quiet) {
  recorder_.Close();
  const RecorderStatus status = recorder_.status();
  board_->recording.store(0, std::memory_order_relaxed);
  const bool whole = status.ended_why.empty() && status.lost == 0;
  if (quiet && whole) return true;
  Screen& screen = TheScreen();
  screen.Tell(Formatted("Recorded %s: %llu ticks, %.1f MB%s", file_.c_str(),
                        static_cast<unsigned long long>(status.ticks),
                        1e-6 * static_cast<double>(status.bytes),
                        whole ? "." : ", NOT the whole run:"));
  if (status.lost > 0)
    screen.Tell(Formatted("%llu ticks could not be written in time. The recording marks the gaps.",
                          static_cast<unsigned long long>(status.lost)));
  if (!status.ended_why.empty()) screen.Tell(status.ended_why);
  if (!quiet && whole) screen.Tell("To make a report, run: predictor report " + file_);
  return status.ended_why.empty();
}

}  // namespace predictor
