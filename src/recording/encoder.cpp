#include "recording/encoder.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "core/text.h"
#include "recording/cdr.h"
#include "recording/schema.h"

namespace predictor::recording {
namespace {

using Json = nlohmann::ordered_json;

// Grows the preamble, and what the index says of it.
class PreambleBuilder {
 public:
  PreambleBuilder() {
    preamble_.bytes = mcap::kMagic;
    preamble_.bytes +=
        mcap::Record(mcap::Op::kHeader, mcap::Bytes().String("ros2").String("predictor").text);
  }
  void AddSchema(std::uint16_t id, const std::string& name, const std::string& encoding,
                 const std::string& text) {
    mcap::Bytes content;
    content.U16(id).String(name).String(encoding).String(text);
    preamble_.schemas.push_back(mcap::Record(mcap::Op::kSchema, content.text));
    preamble_.bytes += preamble_.schemas.back();
  }
  void AddChannel(std::uint16_t id, std::uint16_t schema, const std::string& topic,
                  const std::string& encoding) {
    mcap::Bytes content;
    content.U16(id).U16(schema).String(topic).String(encoding).Strings({});
    preamble_.channels.push_back(mcap::Record(mcap::Op::kChannel, content.text));
    preamble_.bytes += preamble_.channels.back();
  }
  void AddMetadata(const std::string& name, const mcap::Map& map) {
    const std::string record =
        mcap::Record(mcap::Op::kMetadata, mcap::Bytes().String(name).Strings(map).text);
    mcap::Bytes index;
    index.U64(preamble_.bytes.size()).U64(record.size()).String(name);
    preamble_.metadata_indexes += mcap::Record(mcap::Op::kMetadataIndex, index.text);
    preamble_.bytes += record;
    ++preamble_.metadata;
  }
  void AddAttachment(const mcap::Attachment& attachment) {
    const std::string record = ToRecord(attachment);
    mcap::Bytes index;
    index.U64(preamble_.bytes.size()).U64(record.size());
    index.U64(attachment.log_time).U64(attachment.log_time).U64(attachment.data.size());
    index.String(attachment.name).String(attachment.media_type);
    preamble_.attachment_indexes += mcap::Record(mcap::Op::kAttachmentIndex, index.text);
    preamble_.bytes += record;
    ++preamble_.attachments;
  }
  const std::string& bytes() const { return preamble_.bytes; }
  Preamble Take() { return std::move(preamble_); }

 private:
  Preamble preamble_;
};

void AddTopics(const std::vector<JsonChannel>& scene, PreambleBuilder* preamble) {
  // Both hands have one schema.
  std::map<std::string, std::uint16_t> schemas;
  for (int g = 0; g < kGroups; ++g) {
    const GroupName& name = kGroupNames[static_cast<std::size_t>(g)];
    const auto id = static_cast<std::uint16_t>(schemas.size() + 1);
    if (schemas.emplace(name.type, id).second)
      preamble->AddSchema(id, name.type, "ros2msg", Definition(static_cast<Group>(g)));
    preamble->AddChannel(ChannelOf(static_cast<Group>(g)), schemas[name.type], name.topic, "cdr");
  }
  auto next = static_cast<std::uint16_t>(schemas.size() + 1);
  preamble->AddSchema(next, kSnapshotType, "ros2msg", kSnapshotDefinition);
  preamble->AddChannel(kSnapshotChannel, next++, kSnapshotTopic, "cdr");
  preamble->AddSchema(next, kEventType, "jsonschema", EventSchema());
  preamble->AddChannel(kEventChannel, next++, kEventsTopic, "json");
  std::uint16_t channel = kFirstJsonChannel;
  for (const JsonChannel& json : scene) {
    preamble->AddSchema(next, json.schema_name, "jsonschema", json.schema);
    preamble->AddChannel(channel++, next++, json.topic, "json");
  }
}

// Nothing in it: an absent hand, and what was never filled in.
bool IsZero(const HandRecord& hand) {
  static const HandRecord kNone = [] {
    HandRecord none;
    std::memset(&none, 0, sizeof none);
    return none;
  }();
  return SameBits(hand, kNone);
}

bool HasInputs(const TickRecord& record) {
  static const RunInput kNone;
  if (record.input_count != 0) return true;
  for (const RunInput& input : record.inputs)
    if (!SameBits(input, kNone)) return true;
  return false;
}

// Of Foxglove's log: information, warning, error.
int LevelOf(std::string_view kind) {
  if (kind == "stop") return 4;
  return kind == "loss" || kind == "omitted" ? 3 : 2;
}

}  // namespace

std::uint32_t CrcOf(std::uint64_t time) { return mcap::Crc(mcap::Bytes().U64(time).text); }

Preamble MakePreamble(const RecordingHeader& header, const std::vector<JsonChannel>& scene) {
  PreambleBuilder preamble;
  preamble.AddMetadata(kRunMetadata, {{"format", kFormat},
                                      {"scenario", header.scenario_name},
                                      {"version", header.program_version},
                                      {"seed", std::to_string(header.seed)},
                                      {"dt", FormatNumber(header.dt)},
                                      {"start_unix_ns", std::to_string(header.start_unix_ns)}});
  preamble.AddMetadata(kLabelMetadata, header.labels);
  preamble.AddMetadata(kModelMetadata, header.model_hashes);
  const auto time = static_cast<std::uint64_t>(header.start_unix_ns);
  preamble.AddAttachment({kScenarioFile, "application/yaml", time, header.scenario_yaml});
  if (!header.machine_yaml.empty())
    preamble.AddAttachment({kMachineFile, "application/yaml", time, header.machine_yaml});
  for (const RecordingAttachment& file : header.attachments)
    preamble.AddAttachment({file.name, file.media_type, time, file.bytes});
  AddTopics(scene, &preamble);
  preamble.AddMetadata(kPreambleMetadata, {{"bytes", std::to_string(preamble.bytes().size())},
                                           {"crc32", std::to_string(mcap::Crc(preamble.bytes()))}});
  return preamble.Take();
}

std::string EventText(const RecordingEvent& event) {
  Json json = {{"timestamp",
                {{"sec", event.unix_ns / 1'000'000'000}, {"nsec", event.unix_ns % 1'000'000'000}}},
               {"level", LevelOf(event.kind)},
               {"message", event.text},
               {"name", event.kind},
               {"file", ""},
               {"line", 0},
               {"tick", event.tick}};
  if (event.lost != 0) json["lost"] = event.lost;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool ParseEvent(std::string_view text, RecordingEvent* event) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return false;
  const auto tick = json.find("tick"), kind = json.find("name"), words = json.find("message"),
             lost = json.find("lost");
  if (tick == json.end() || !tick->is_number_unsigned() || kind == json.end() ||
      !kind->is_string() || words == json.end() || !words->is_string() ||
      (lost != json.end() && !lost->is_number_unsigned()))
    return false;
  event->tick = *tick;
  event->kind = *kind;
  event->text = *words;
  event->lost = lost == json.end() ? 0 : lost->get<std::uint64_t>();
  return true;
}

Encoder::Encoder(const RecordingHeader& header, std::vector<JsonChannel> scene)
    : dt_(header.dt),
      start_ns_(static_cast<std::uint64_t>(header.start_unix_ns)),
      scene_(std::move(scene)),
      now_ns_(start_ns_) {}

// By the clock, if the record tells it; in virtual time by the tick. It never runs backwards.
std::uint64_t Encoder::TimeOf(const TickRecord& record) {
  std::uint64_t since = 0;
  if (record.wall_ns == 0) {
    since = static_cast<std::uint64_t>(std::llround(static_cast<double>(record.tick) * dt_ * 1e9));
  } else {
    if (first_wall_ns_ == 0) first_wall_ns_ = record.wall_ns;
    since = record.wall_ns < first_wall_ns_ ? 0 : record.wall_ns - first_wall_ns_;
  }
  now_ns_ = std::max(now_ns_, start_ns_ + since);
  return now_ns_;
}

template <class R>
void Encoder::AddGroup(Group group, const R& record, std::uint64_t time) {
  std::byte* to = chunk_.Begin(kLongestTickMessage);
  CdrWriter writer(to);
  VisitGroup(group, writer, record);
  const auto crc = [&] {
    return mcap::Crc({reinterpret_cast<const char*>(to), writer.size()}, crc_);
  };
  crc_ = crc();
  if (group == Group::kTiming) writer.Value("record_crc", crc_);
  chunk_.End(ChannelOf(group), static_cast<std::uint32_t>(record.tick), time, writer.size());
}

void Encoder::Add(const TickRecord& record) {
  const std::uint64_t time = TimeOf(record);
  crc_ = CrcOf(time);
  for (int g = 0; g < kGroups; ++g) {
    const auto group = static_cast<Group>(g);
    if (group == Group::kInputs && !HasInputs(record)) continue;
    if (group == Group::kLeft && IsZero(record.hands[0])) continue;
    if (group == Group::kRight && IsZero(record.hands[1])) continue;
    AddGroup(group, record, time);
  }
  chunk_.CountTick();
  for (const RecordingEvent& event : run_events_.Follow(record, time)) AddEvent(event);
  if (!scene_.empty() && (scene_ns_ == 0 || time - scene_ns_ >= kScenePeriod))
    AddScene(record, time);
}

void Encoder::AddScene(const TickRecord& record, std::uint64_t time) {
  scene_ns_ = time;
  std::uint16_t channel = kFirstJsonChannel;
  for (const JsonChannel& json : scene_)
    chunk_.Add(channel++, static_cast<std::uint32_t>(record.tick), time,
               json.message(record, time));
}

void Encoder::AddSnapshot(std::uint64_t tick, std::span<const std::byte> data) {
  if (data.size() > kLargestSnapshot)
    throw std::invalid_argument("a snapshot is larger than a recording holds");
  const std::size_t most = kCdrHead + 8 + 4 + data.size();
  std::byte* to = chunk_.Begin(most);
  CdrWriter writer(to);
  writer.Value("tick", tick);
  writer.Value("data", static_cast<std::uint32_t>(data.size()));
  if (!data.empty()) std::memcpy(to + writer.size(), data.data(), data.size());
  chunk_.End(kSnapshotChannel, snapshots_++, now_ns_, writer.size() + data.size());
}

void Encoder::AddEvent(const RecordingEvent& event) {
  RecordingEvent timed = event;
  timed.unix_ns = now_ns_;
  chunk_.Add(kEventChannel, events_++, now_ns_, EventText(timed));
}

bool Encoder::Due() const {
  return !chunk_.empty() &&
         (chunk_.size() >= kChunkBytes || now_ns_ - chunk_.start_time() >= kChunkTime);
}

}  // namespace predictor::recording
