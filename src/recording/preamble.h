// What stands before the first chunk: made, and read back though parts of it are damaged. Each
// piece proves itself by a CRC, and all but large files have a second place behind the first chunk.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/fields.h"
#include "recording/header.h"
#include "recording/input.h"
#include "recording/mcap_file.h"

namespace predictor::recording {

inline constexpr const char* kFormat = "2";  // of the metadata and the preamble

inline constexpr std::uint64_t kLargestPreamble = 128U << 20U;  // [bytes]
inline constexpr std::size_t kMostPreambleRecords = 10'000;
inline constexpr double kShortestTick = 1e-4, kLongestTick = 1;  // [s]

// Channel of a group; behind the groups: snapshots, events, then those in JSON.
constexpr std::uint16_t ChannelOf(Group group) {
  return static_cast<std::uint16_t>(static_cast<int>(group) + 1);
}
inline constexpr std::uint16_t kSnapshotChannel = kGroups + 1;
inline constexpr std::uint16_t kEventChannel = kGroups + 2;
inline constexpr std::uint16_t kFirstJsonChannel = kGroups + 3;

// The preamble's bytes, what the index says of them, and what is written again.
Preamble MakePreamble(const RecordingHeader& header, const std::vector<JsonChannel>& scene);

struct Opening {
  RecordingHeader header;
  std::vector<JsonChannel> scene;  // without what makes their messages
  std::uint64_t end = 0;           // where the chunks begin
  bool damaged = false;            // something of it is not as it was written
  std::string damage;              // in sentences for a person: what was mended, what is lost
};
// Throws InputError: no recording, of another version, or damaged in both places.
Opening ReadOpening(const InputFile& file);

// What stands between chunks, whole: an index of messages, or the copy.
bool IsBetweenChunks(const InputFile& file, std::uint64_t offset, const RecordHead& head);

}  // namespace predictor::recording
