// A recording as commands make and open it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "emulator/emulator.h"
#include "recording/header.h"
#include "recording/writer.h"

namespace predictor {

// Where and how a run is recorded.
struct RecordOptions {
  std::string file;                 // empty: none, or as the command's rule is
  bool off = false;                 // no recording, also where it is the rule
  std::vector<std::string> labels;  // "key=value"
  std::string machine;              // of real arms, as YAML

  // Throws InputError.
  std::map<std::string, std::string> Labels() const;
};

// Header of a recording of `emulator`'s run that begins now.
RecordingHeader HeaderOf(const Emulator& emulator, const RecordOptions& options);

// "runs/box_9kg_2026-01-31_14-05-09.mcap", with a number if that is there already. Makes the
// folder.
std::string NewRecordingName(const Scenario& scenario);

// In virtual time nothing waits for the recording: it is written where it arises.
class VirtualRecording {
 public:
  // Throws InputError if the file cannot be made.
  VirtualRecording(Emulator* emulator, const RecordOptions& options);
  // After each tick. Throws RecordingError.
  void Add(const TickRecord& record);
  void Close() { writer_.Close(); }
  std::string Told() const;  // what was written, as a sentence

 private:
  Emulator* emulator_;
  std::string file_;
  RecordingWriter writer_;
  std::uint64_t snapshot_ticks_;  // between two of them
  std::vector<std::byte> state_;
};

// A folder of this process's own that goes when it does.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace predictor
