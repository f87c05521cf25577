// Reads the preamble of a recording, even if the preamble is partly damaged.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/header.h"
#include "recording/input.h"

namespace predictor::recording {

struct Opening {
  RecordingHeader header;
  std::vector<JsonChannel> scene;  // channels of the scene, without their message functions
  std::uint64_t end = 0;           // position of the first chunk
  bool damaged = false;            // the content differs from what was written
  std::string damage;              // sentences for the user about repaired and lost parts
};
// Throws InputError if the file is not a recording, has another version, or is damaged in both
// places.
Opening ReadOpening(const InputFile& file);

// Returns true for complete data between chunks, which are an index of messages or the copy.
bool IsBetweenChunks(const InputFile& file, std::uint64_t offset, const RecordHead& head);

}  // namespace predictor::recording
