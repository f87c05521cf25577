// The contents of a recording apart from its ticks.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/predicted_loop.h"
#include "core/record.h"

namespace predictor {

// A file in the recording: a URDF, or a mesh that no package contains.
struct RecordingAttachment {
  std::string name, media_type, bytes;
};

struct RecordingHeader {
  std::string scenario_yaml;  // resolved: contains every value of the run
  std::string scenario_name;
  std::string machine_yaml;  // may be empty
  std::string program_version;
  std::string engine;  // name and version of the physics engine; empty in older recordings
  std::uint64_t seed = 0;
  double dt = 0;                      // duration of a tick [s]
  std::optional<PredictedLoop> loop;  // absent in mode `direct` and in older recordings
  std::map<std::string, std::string> labels;
  std::map<std::string, std::string> model_hashes;  // attachment's name -> SHA-256
  std::vector<RecordingAttachment> attachments;
  std::vector<std::string> lost;   // parts destroyed by damage; only set for a recording that was
                                   // read
  std::int64_t start_unix_ns = 0;  // time of tick 0 in virtual time, or of the first record [ns]
};

// A topic whose messages are JSON, with at most 50 messages per second.
struct JsonChannel {
  std::string topic, schema_name;
  std::string schema;  // JSON Schema
  // Converts a record of a tick to a message. `message` is empty if the topic's messages are not
  // computed from ticks.
  std::function<std::string(const TickRecord& record, std::uint64_t unix_ns)> message;
};

// The topic of the person's states (core/person_json.h), with at most 100 messages per second.
inline constexpr const char* kPersonTopic = "/person/state";
JsonChannel PersonChannel();
// The topic of the measured poses of the person's head (recording/head_stream.h), at most 60 per
// second.
inline constexpr const char* kHeadTopic = "/person/head";
JsonChannel HeadChannel();
// The topics of the descriptions and the samples of streams that other systems sent
// (recording/sample_stream.h).
inline constexpr const char* kStreamsTopic = "/person/streams";
JsonChannel StreamsChannel();
inline constexpr const char* kSamplesTopic = "/person/samples";
JsonChannel SamplesChannel();

// A stream that was recorded during the run.
struct RecordedStream {
  std::string description;     // JSON object with unchecked content; "": it is lost
  std::size_t channels = 0;    // 0: no samples
  std::vector<double> times;   // since the start of the recording [s]
  std::vector<double> values;  // `channels` values for each time; NaN: missing
  bool complete = true;        // false: the recording has more samples than the reader reads
};

// An event, for example a marker, lost ticks or a stop.
struct RecordingEvent {
  std::uint64_t tick = 0;  // the newest tick when the event was recorded
  std::uint64_t unix_ns = 0;
  // The kind is "event", "marker" if a person set the marker, or "loss" if ticks before `tick` are
  // missing. The following kinds are derived from the ticks: "state", "stop", "reset", "parameter",
  // "hazard", and "omitted". An event of the kind "omitted" contains the number of events above the
  // limit.
  std::string kind;
  std::string text;
  std::uint64_t lost = 0;  // number of lost ticks
};

}  // namespace predictor
