// What a recording holds beside its ticks.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// A file within the recording: a URDF, a mesh that no package holds.
struct RecordingAttachment {
  std::string name, media_type, bytes;
};

struct RecordingHeader {
  std::string scenario_yaml;  // resolved: with every value that the run was given
  std::string scenario_name;
  std::string machine_yaml;  // empty: none
  std::string program_version;
  std::uint64_t seed = 0;
  double dt = 0;  // of a tick [s]
  std::map<std::string, std::string> labels;
  std::map<std::string, std::string> model_hashes;  // attachment's name -> SHA-256
  std::vector<RecordingAttachment> attachments;
  std::vector<std::string> lost;   // names of what damage took of all this; of a run that is read
  std::int64_t start_unix_ns = 0;  // when tick 0 of virtual time, or the first record, was [ns]
};

// A topic in JSON, at no more than 50 Hz.
struct JsonChannel {
  std::string topic, schema_name;
  std::string schema;  // JSON Schema
  std::function<std::string(const TickRecord& record, std::uint64_t unix_ns)> message;
};

// Something that happened: a marker, ticks that were lost, a stop.
struct RecordingEvent {
  std::uint64_t tick = 0;  // the newest when it was noted
  std::uint64_t unix_ns = 0;
  // "event"; "marker", set by a person; "loss": ticks before `tick` are missing; and out of the
  // ticks themselves: "state", "stop", "reset", "parameter",
  // and "omitted": more of these than there is room for.
  std::string kind;
  std::string text;
  std::uint64_t lost = 0;  // ticks
};

}  // namespace predictor
