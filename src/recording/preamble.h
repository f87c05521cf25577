// The part of a recording before the first chunk: written, and read back even if it is partly
// damaged. Each part has a CRC, and all parts except large files have a copy after the first chunk.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/tick_fields.h"
#include "recording/header.h"
#include "recording/input.h"
#include "recording/mcap_file.h"

namespace predictor::recording {

inline constexpr const char* kFormat = "2";  // version of the metadata and the preamble

inline constexpr std::uint64_t kLargestPreamble = 128U << 20U;  // [bytes]
inline constexpr std::size_t kMostPreambleRecords = 10'000;
inline constexpr double kShortestTick = 1e-4, kLongestTick = 1;  // [s]

// Channel ID of a group; the IDs after the groups are for snapshots, events, and JSON-encoded
// events.
constexpr std::uint16_t ChannelOf(TickGroup group) {
  return static_cast<std::uint16_t>(static_cast<int>(group) + 1);
}
inline constexpr std::uint16_t kSnapshotChannel = kTickGroupCount + 1;
inline constexpr std::uint16_t kEventChannel = kTickGroupCount + 2;
inline constexpr std::uint16_t kFirstJsonChannel = kTickGroupCount + 3;

// The preamble's bytes, its index entries, and the parts that are rewritten.
Preamble MakePreamble(const RecordingHeader& header, const std::vector<JsonChannel>& scene);

struct Opening {
  RecordingHeader header;
  std::vector<JsonChannel> scene;  // without their message functions
  std::uint64_t end = 0;           // position of the first chunk
  bool damaged = false;            // the content differs from what was written
  std::string damage;              // sentences for the user about repaired and lost parts
};
// Throws InputError if the file is not a recording, has another version, or is damaged in both
// places.
Opening ReadOpening(const InputFile& file);

// True for complete data between chunks: an index of messages, or the copy.
bool IsBetweenChunks(const InputFile& file, std::uint64_t offset, const RecordHead& head);

}  // namespace predictor::recording
