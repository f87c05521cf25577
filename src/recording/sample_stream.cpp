#include "recording/sample_stream.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace predictor {
namespace recording {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLongestMessage = 10;  // time between its first and its last sample [s]

Json Numbers(const char* meaning) {
  return {{"type", "array"}, {"items", {{"type", "number"}}}, {"description", meaning}};
}

std::size_t IndexOfStream(const Json& json) {
  const auto found = json.find("stream");
  if (found == json.end() || !found->is_number_unsigned()) return kMaxStreams;
  return std::min(found->get<std::size_t>(), kMaxStreams);
}

// Returns NaN for null, which means that the value is missing.
bool ReadValue(const Json& json, double* value) {
  *value = std::numeric_limits<double>::quiet_NaN();
  if (json.is_null()) return true;
  if (!json.is_number()) return false;
  *value = json;
  return std::abs(*value) <= kLargestStreamValue;
}

bool ReadRow(const Json& row, std::size_t count, std::vector<double>* values) {
  if (!row.is_array() || row.size() != count) return false;
  for (const Json& cell : row) {
    double value = 0;
    if (!ReadValue(cell, &value)) return false;
    values->push_back(value);
  }
  return true;
}

}  // namespace

std::string DescriptionJson(std::size_t stream, const std::string& text) {
  return R"({"stream":)" + std::to_string(stream) + R"(,"description":)" + text + "}";
}

std::string DescriptionSchema() {
  return Json{{"type", "object"},
              {"description", "a stream of measurements of the person that another system sent"},
              {"properties",
               {{"stream", {{"type", "integer"}, {"description", "index in /person/samples"}}},
                {"description",
                 {{"type", "object"},
                  {"description",
                   "name, rate, channels and units as the sender states them, and the mapping to "
                   "the body"}}}}},
              {"required", {"stream", "description"}}}
      .dump();
}

bool ParseDescription(std::string_view text, std::size_t* stream, std::string* description) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || IndexOfStream(json) == kMaxStreams) return false;
  const auto found = json.find("description");
  if (found == json.end() || !found->is_object()) return false;
  *stream = IndexOfStream(json);
  *description = found->dump();
  return true;
}

std::string SamplesJson(std::span<const StreamSample> samples) {
  const StreamSample& first = samples.front();
  Json times = Json::array(), values = Json::array();
  for (const StreamSample& sample : samples) {
    times.push_back(1e-9 * static_cast<double>(sample.wall_ns - first.wall_ns));
    values.push_back(std::span(sample.values).first(sample.count));
  }
  return Json{{"stream", first.stream},
              {"clock_offset", first.clock_offset},
              {"times", std::move(times)},
              {"values", std::move(values)}}
      .dump();
}

std::string SamplesSchema() {
  Json rows = {{"type", "array"}, {"description", "one row for each time; null: missing"}};
  rows["items"] = {{"type", "array"}, {"items", {{"type", {"number", "null"}}}}};
  return Json{{"type", "object"},
              {"description", "samples of a stream of /person/streams"},
              {"properties",
               {{"stream", {{"type", "integer"}, {"description", "index in /person/streams"}}},
                {"clock_offset",
                 {{"type", "number"}, {"description", "[s] that was added to the sender's clock"}}},
                {"times", Numbers("[s] since the message's time")},
                {"values", rows}}},
              {"required", {"stream", "clock_offset", "times", "values"}}}
      .dump();
}

std::size_t StreamOf(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  return json.is_object() ? IndexOfStream(json) : kMaxStreams;
}

bool ParseSamples(std::string_view text, std::size_t index, double time, RecordedStream* stream) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || IndexOfStream(json) != index) return false;
  const auto times = json.find("times"), values = json.find("values");
  if (times == json.end() || values == json.end() || !times->is_array() || !values->is_array() ||
      times->empty() || times->size() > kMaxSamplesInMessage || values->size() != times->size() ||
      !values->front().is_array())
    return false;
  const std::size_t count = values->front().size();
  if (count == 0 || count > kMaxStreamChannels) return false;
  if (stream->channels == 0) stream->channels = count;
  if (stream->channels != count) return false;
  for (std::size_t i = 0; i < times->size(); ++i) {
    if (!(*times)[i].is_number() || !ReadRow((*values)[i], count, &stream->values)) return false;
    const double after = (*times)[i];
    if (!(after >= 0 && after <= kLongestMessage)) return false;
    stream->times.push_back(time + after);
  }
  return true;
}

}  // namespace recording

JsonChannel StreamsChannel() {
  return {kStreamsTopic, "predictor.PersonStream", recording::DescriptionSchema(), {}};
}

JsonChannel SamplesChannel() {
  return {kSamplesTopic, "predictor.PersonSamples", recording::SamplesSchema(), {}};
}

}  // namespace predictor
