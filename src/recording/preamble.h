// Writes the part of a recording before the first chunk. Each part of it has a CRC, and all parts
// except large files have a copy after the first chunk.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/tick_fields.h"
#include "recording/header.h"
#include "recording/mcap_file.h"

namespace predictor::recording {

inline constexpr const char* kFormat = "2";  // version of the metadata and the preamble

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

}  // namespace predictor::recording
