// The streams of a recording that contain what other systems measured on the person during the run.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/stream_sample.h"
#include "recording/header.h"

namespace predictor::recording {

inline constexpr std::size_t kMaxSamplesInMessage = 64;

// Returns {"stream": k, "description": …}, where the description is the JSON object `text`.
std::string DescriptionJson(std::size_t stream, const std::string& text);
std::string DescriptionSchema();  // JSON Schema (draft-07)
// Returns false if the text is something else.
bool ParseDescription(std::string_view text, std::size_t* stream, std::string* description);

// Returns {"stream": k, "clock_offset": …, "times": […], "values": [[…], …]} for successive samples
// of one stream. The times are relative to the first sample, which has the message's time.
std::string SamplesJson(std::span<const StreamSample> samples);
std::string SamplesSchema();  // JSON Schema (draft-07)
// Adds the samples of a message at `time` [s] to `stream`. Returns false if the text is something
// else, exceeds the limits of core/stream_sample.h, or has another number of channels than the
// samples before. `index` is the stream to which the message must belong.
bool ParseSamples(std::string_view text, std::size_t index, double time, RecordedStream* stream);
// Returns the stream of a message of samples, or kMaxStreams if the text is something else.
std::size_t StreamOf(std::string_view text);

}  // namespace predictor::recording
