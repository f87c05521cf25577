#include "recording/encoder.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "core/person_json.h"
#include "recording/cdr.h"
#include "recording/head_stream.h"
#include "recording/sample_stream.h"

namespace predictor::recording {
namespace {

using Json = nlohmann::ordered_json;

// Returns whether nothing was written to the record, because the hand is absent or was never filled
// in.
bool IsZero(const HandRecord& hand) {
  static const HandRecord kNone = [] {
    HandRecord none;
    std::memset(&none, 0, sizeof none);
    return none;
  }();
  return SameBits(hand, kNone);
}

bool HasMovables(const TickRecord& record) {
  static constexpr std::array<PoseRecord, kMaxMovables> kNone{};
  return record.movable_count != 0 || record.held != 0 || record.held_grip != 0 ||
         !SameBits(record.movables, kNone);
}

bool HasInputs(const TickRecord& record) {
  static const RunInput kNone;
  if (record.input_count != 0) return true;
  for (const RunInput& input : record.inputs)
    if (!SameBits(input, kNone)) return true;
  return false;
}

// Returns a level of Foxglove's log: information, warning or error.
int LevelOf(std::string_view kind) {
  if (kind == "stop") return 4;
  return kind == "loss" || kind == "omitted" ? 3 : 2;
}

}  // namespace

std::uint32_t CrcOf(std::uint64_t time) { return mcap::Crc(mcap::Bytes().U64(time).text); }

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
      person_channel_(ChannelOf(scene_, kPersonTopic)),
      head_channel_(ChannelOf(scene_, kHeadTopic)),
      streams_channel_(ChannelOf(scene_, kStreamsTopic)),
      samples_channel_(ChannelOf(scene_, kSamplesTopic)),
      now_ns_(start_ns_) {}

// Uses the clock time if the record contains one, and otherwise (in virtual time) the number of the
// tick. The time never decreases.
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
void Encoder::AddGroup(TickGroup group, const R& record, std::uint64_t time) {
  std::byte* to = chunk_.Begin(kLongestTickMessage);
  CdrWriter writer(to);
  VisitGroup(group, writer, record);
  const auto crc = [&] {
    return mcap::Crc({reinterpret_cast<const char*>(to), writer.size()}, crc_);
  };
  crc_ = crc();
  if (group == TickGroup::kTiming) writer.Put(crc_);
  chunk_.End(ChannelOf(group), static_cast<std::uint32_t>(record.tick), time, writer.size());
}

void Encoder::Add(const TickRecord& record) {
  const std::uint64_t time = TimeOf(record);
  crc_ = CrcOf(time);
  for (int g = 0; g < kTickGroupCount; ++g) {
    const auto group = static_cast<TickGroup>(g);
    if (group == TickGroup::kInputs && !HasInputs(record)) continue;
    if (group == TickGroup::kLeft && IsZero(record.hands[0])) continue;
    if (group == TickGroup::kRight && IsZero(record.hands[1])) continue;
    if (group == TickGroup::kMovables && !HasMovables(record)) continue;
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
  for (const JsonChannel& json : scene_) {
    if (json.message)
      chunk_.Add(channel, static_cast<std::uint32_t>(record.tick), time,
                 json.message(record, time));
    ++channel;
  }
}

// The person's state has the time of its tick. The messages of this tick must have been added
// before.
void Encoder::AddPerson(const PersonState& state) {
  if (person_channel_ == 0) return;
  std::uint64_t time = now_ns_;
  if (first_wall_ns_ != 0 && state.wall_ns >= first_wall_ns_)
    time = std::min(time, start_ns_ + (state.wall_ns - first_wall_ns_));
  chunk_.Add(person_channel_, static_cast<std::uint32_t>(state.tick), time, PersonJson(state));
}

void Encoder::AddHead(const HeadRecord& head, std::uint64_t tick) {
  if (head_channel_ == 0 || first_wall_ns_ == 0 || head.wall_ns < first_wall_ns_) return;
  const std::uint64_t time = start_ns_ + (head.wall_ns - first_wall_ns_);
  if (time <= now_ns_)
    chunk_.Add(head_channel_, static_cast<std::uint32_t>(tick), time, HeadJson(head));
}

void Encoder::AddStream(std::size_t stream, const std::string& description, std::uint64_t tick) {
  if (streams_channel_ == 0) return;
  chunk_.Add(streams_channel_, static_cast<std::uint32_t>(tick), now_ns_,
             DescriptionJson(stream, description));
}

void Encoder::AddSamples(std::span<const StreamSample> samples, std::uint64_t tick) {
  if (samples_channel_ == 0 || first_wall_ns_ == 0) return;
  while (!samples.empty() && samples.front().wall_ns < first_wall_ns_) samples = samples.subspan(1);
  if (samples.empty()) return;
  const std::uint64_t time = start_ns_ + (samples.front().wall_ns - first_wall_ns_);
  if (time <= now_ns_)
    chunk_.Add(samples_channel_, static_cast<std::uint32_t>(tick), time, SamplesJson(samples));
}

void Encoder::AddSnapshot(std::uint64_t tick, std::span<const std::byte> data) {
  if (data.size() > kLargestSnapshot)
    throw std::invalid_argument("a saved state is too large for a recording");
  const std::size_t most = kCdrHead + 8 + 4 + data.size();
  std::byte* to = chunk_.Begin(most);
  CdrWriter writer(to);
  writer.Put(tick);
  writer.Put(static_cast<std::uint32_t>(data.size()));
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
