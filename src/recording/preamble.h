// Writes the part of a recording before the first chunk. Each part of the preamble has a CRC, and
// all parts except large files have a copy after the first chunk.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/tick_fields.h"
#include "recording/header.h"
#include "recording/mcap_file.h"

namespace predictor::recording {

inline constexpr const char* kFormat = "2";  // version of the metadata and the preamble

// Returns the channel ID of a group. The IDs after the groups are for snapshots, events, and events
// in JSON.
constexpr std::uint16_t ChannelOf(TickGroup group) {
  return static_cast<std::uint16_t>(static_cast<int>(group) + 1);
}
inline constexpr std::uint16_t kSnapshotChannel = kTickGroupCount + 1;
inline constexpr std::uint16_t kEventChannel = kTickGroupCount + 2;
inline constexpr std::uint16_t kFirstJsonChannel = kTickGroupCount + 3;
// Returns the channel ID of a topic of the scene, or 0 if the recording has no such topic.
std::uint16_t ChannelOf(const std::vector<JsonChannel>& scene, std::string_view topic);

// The names of the metadata and attachments, and of the parts of the preamble that contain these
// metadata and attachments.
inline constexpr const char* kRunMetadata = "predictor.run";
inline constexpr const char* kLabelMetadata = "predictor.labels";
inline constexpr const char* kModelMetadata = "predictor.models";
// The parts that were lost to damage before the recording was repaired.
inline constexpr const char* kLostMetadata = "predictor.lost";
inline constexpr const char* kScenarioFile = "scenario.yaml";
inline constexpr const char* kMachineFile = "machine.yaml";
inline constexpr const char* kTopics = "topics";  // the part with the schemas and channels
inline constexpr const char* kCopy = "predictor.copy";
inline constexpr const char* kBytes = "application/octet-stream";

// The names of entries in the run's metadata: the list of the parts that follow the metadata, the
// CRC of the layout of ticks, and the CRC of the metadata itself.
inline constexpr const char* kContents = "contents";
inline constexpr const char* kLayout = "layout";
inline constexpr const char* kCrc = "crc32";
// The names of the entries with the lead and the stability margin of the predicted haptic loop,
// which exist only if these values are available.
inline constexpr const char* kLead = "lead_s";
inline constexpr const char* kMargin = "stability_margin";

// Parts that are larger than this are not copied.
inline constexpr std::uint64_t kLargestCopied = 256U << 10U;  // maximum per part [bytes]
inline constexpr std::uint64_t kLargestCopy = 8U << 20U;      // [bytes]
inline constexpr std::uint64_t kLargestRun = 2U << 20U;       // the run's metadata [bytes]

// Returns the first bytes of the file, which are always the same.
const std::string& Beginning();

// Returns the CRC of all entries except the CRC entry itself.
std::string CrcOfRun(mcap::Map run);

// Returns the CRC of the layout of a tick's bytes. The CRC of the layout makes it possible to read
// ticks even if their schemas are lost.
std::string LayoutCrc();

// Returns the preamble's bytes, its index entries, and the parts that are written again.
Preamble MakePreamble(const RecordingHeader& header, const std::vector<JsonChannel>& scene);

}  // namespace predictor::recording
