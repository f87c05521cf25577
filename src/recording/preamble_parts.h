// The parts of a preamble, as it is written (preamble.cpp) and read (opening.cpp).
#pragma once

#include <cstdint>
#include <string>

#include "recording/mcap.h"

namespace predictor::recording {

// Names of the metadata and attachments, and of the parts of the preamble that contain them.
inline constexpr const char* kRunMetadata = "predictor.run";
inline constexpr const char* kLabelMetadata = "predictor.labels";
inline constexpr const char* kModelMetadata = "predictor.models";
// Parts that were lost to damage before the recording was repaired.
inline constexpr const char* kLostMetadata = "predictor.lost";
inline constexpr const char* kScenarioFile = "scenario.yaml";
inline constexpr const char* kMachineFile = "machine.yaml";
inline constexpr const char* kTopics = "topics";  // the part with the schemas and channels
inline constexpr const char* kCopy = "predictor.copy";
inline constexpr const char* kBytes = "application/octet-stream";

// Entries in the run's metadata: the list of the parts that follow it, and the CRC of the metadata
// itself.
inline constexpr const char* kContents = "contents";
inline constexpr const char* kLayout = "layout";
inline constexpr const char* kCrc = "crc32";
// Entry for the predicted haptic loop, if available.
inline constexpr const char* kLead = "lead_s";
inline constexpr const char* kMargin = "stability_margin";

// Larger parts are not written twice.
inline constexpr std::uint64_t kLargestCopied = 256U << 10U;  // per part [bytes]
inline constexpr std::uint64_t kLargestCopy = 8U << 20U;      // [bytes]
inline constexpr std::uint64_t kLargestRun = 2U << 20U;       // the run's metadata [bytes]

// The first bytes of the file, which are always the same.
const std::string& Beginning();

// CRC of all entries except the CRC entry itself.
std::string CrcOfRun(mcap::Map run);

// CRC of the layout of a tick's bytes, so that ticks can be read even if their schemas are lost.
std::string LayoutCrc();

}  // namespace predictor::recording
