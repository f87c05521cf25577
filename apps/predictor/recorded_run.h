// Functions with which commands make and open recordings.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "live_evaluation.h"
#include "open_recording.h"
#include "recording/header.h"
#include "recording/reader.h"
#include "recording/recorder.h"
#include "recording/writer.h"

namespace predictor {

// The options that determine whether, where and how a run is recorded.
struct RecordOptions {
  std::string file;                 // empty: the command's default
  bool off = false;                 // no recording, even if it is the default
  std::vector<std::string> labels;  // "key=value"
  std::string participant;          // file of the person in a study; empty: none
  std::string machine;              // machine file of real arms, as YAML

  // Returns all labels, including the labels of the participant. Throws InputError.
  std::map<std::string, std::string> Labels() const;
};

// Returns the header for a recording of `emulator`'s run that begins now.
RecordingHeader HeaderOf(const Emulator& emulator, const RecordOptions& options);

// Returns a name such as "runs/box_9kg_2026-01-31_14-05-09.mcap". If that file exists, the name
// also contains a number. Creates the folder.
std::string NewRecordingName(const Scenario& scenario);

// Reads the remaining ticks and shows the progress. A separate thread reads the ticks, because
// unpacking and checking take twice as long as evaluating. Throws InputError.
void ReadTicks(RecordingReader* reader, const std::string& title, bool quiet,
               const std::function<void(const TickRecord&)>& add);

// Records a run in virtual time. In virtual time, no device waits for the loop, so the recorder
// writes in the simulation's own thread.
class VirtualRecording {
 public:
  // Throws InputError if the file cannot be created.
  VirtualRecording(Emulator* emulator, const RecordOptions& options);
  // Call this function after each tick. Throws RecordingError.
  void Add(const TickRecord& record);
  void Close();
  std::string Summary() const;  // summary of the written file, as a sentence

 private:
  Emulator* emulator_;
  std::string file_;
  RecordingWriter writer_;
  std::uint64_t snapshot_ticks_;  // ticks between two saved states
  std::vector<std::byte> state_;
  std::optional<OpenRecording> open_;
};

// Records a run in real time.
class RunRecording final : public SnapshotSink {
 public:
  // Records everything that is published on the board after this call. The file is `options.file`
  // or, if this name is empty, the file of NewRecordingName. The board shows whether the recorder
  // is recording. `person` is the board of the evaluator's states, which are also recorded, or
  // null. `heads` are the measured heads, which are also recorded, and so are `streams`, or null.
  // The boards, the heads and the streams are borrowed. Throws InputError.
  RunRecording(const Emulator& emulator, const RecordOptions& options, RunBoard* board,
               const EvaluationBoard* person, const HeadRing& heads, const PersonStreams* streams);

  std::span<std::byte> AcquireBuffer() noexcept override { return recorder_.SnapshotBuffer(); }
  void Commit(std::uint64_t tick, std::size_t bytes) noexcept override {
    recorder_.SnapshotTaken(tick, bytes);
  }
  // Updates the board's recording state. Call this function regularly, but not in the tick's
  // thread.
  void Look();
  // Adds a marker that helps people who evaluate the recording.
  void Mark(const std::string& text) { recorder_.Mark(text); }
  // Ends the recording and prints its result unless quiet. If the program does not make a report
  // itself, the function also prints the command that makes a report. Returns whether the recording
  // lasted until the end.
  bool Close(bool quiet, bool has_report);
  const std::string& file() const { return file_; }

 private:
  RunBoard* board_;
  std::string file_;
  Recorder recorder_;
  std::optional<OpenRecording> open_;
};

}  // namespace predictor
