#include "recording/reader.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "recording/encoder.h"
#include "recording/head_stream.h"
#include "recording/input.h"
#include "recording/opening.h"
#include "recording/preamble.h"
#include "recording/sample_stream.h"

namespace predictor {

using recording::ChunkAt;
using recording::InputFile;
using recording::Message;
using recording::ReadChunk;
using recording::TickDecoder;

namespace {

// The following limits ensure that a hostile file does not exhaust memory. No real run has as many
// events as this limit, and further events are only counted.
constexpr std::size_t kMaxLoggedEvents = 200'000;
constexpr std::size_t kMaxEventBytes = 64U << 20U;
constexpr std::size_t kLongestEvent = 64 * 1024;     // [bytes]
constexpr std::size_t kLongestHead = 4 * 1024;       // [bytes]
constexpr std::size_t kLongestSamples = 256 * 1024;  // [bytes]
constexpr std::size_t kMaxStreamValues = 1U << 26U;  // of all streams together
constexpr std::size_t kMaxSnapshots = 1'000'000;
constexpr std::size_t kMaxHeads = 1'000'000;      // more than four hours
constexpr std::uint64_t kReadAtOnce = 1U << 20U;  // [bytes]

}  // namespace

struct RecordingReader::Impl {
  explicit Impl(const std::string& path) : file(path), opening(ReadOpening(file)) {
    complete = ReadSummary();
    if (!complete) Scan();
    if (!opening.damage.empty()) problem = opening.damage + (problem.empty() ? "" : " ") + problem;
    first_ticks.resize(chunks.size());
  }

  bool ReadSummary();
  bool ParseSummary(std::string_view summary, std::uint64_t start);
  void Scan();
  void Load(std::size_t chunk);
  bool NextOf(TickRecord* record);
  std::optional<std::uint64_t> FirstTick(std::size_t chunk);
  void FindOthers();
  void FindOthersIn(std::size_t chunk);
  void TakeEvent(std::size_t chunk, const Message& message);
  void TakeHead(std::size_t chunk, const Message& message, std::vector<RecordedHead>* heads) const;
  void TakeStream(std::size_t chunk, const Message& message, std::vector<RecordedStream>* s) const;
  void TakeSamples(std::size_t chunk, const Message& message, std::vector<RecordedStream>* s) const;
  template <class Take>
  void ForEachOn(std::uint16_t channel, const Take& take) const;
  void CheckIndexes(const mcap::ChunkIndex& index) const;

  InputFile file;
  recording::Opening opening;
  bool complete = false;
  std::string problem;
  std::vector<mcap::ChunkIndex> chunks;
  std::optional<std::uint64_t> count;

  // The position at which the next call of Next() reads.
  std::size_t next_chunk = 0;
  std::size_t chunk = 0;  // chunk that `rest` belongs to
  std::string messages;
  std::string_view rest;
  TickDecoder decoder;
  std::optional<TickRecord> pending;  // record found by Seek

  struct SnapshotPlace {
    std::size_t chunk;
    std::uint64_t offset;
  };
  // The first tick of each chunk, or no value if the chunk has not been read.
  std::vector<std::optional<std::optional<std::uint64_t>>> first_ticks;
  bool others_found = false;
  std::vector<RecordingEvent> events;
  std::size_t event_bytes = 0;
  std::uint64_t more_events = 0;
  std::vector<std::uint64_t> snapshots;
  std::vector<SnapshotPlace> places;  // positions of snapshots
};

// ---- opening ------------------------------------------------------------------------------------

bool RecordingReader::Impl::ReadSummary() {
  problem = "The recording was not closed, so it is read up to its last complete chunk.";
  if (file.size() < opening.end + mcap::kFooterBytes) return false;
  const std::uint64_t at = file.size() - mcap::kFooterBytes;
  const std::string tail = file.Read(at, mcap::kFooterBytes);
  mcap::Parser from{tail};
  const auto op = from.Number<mcap::Op>();
  const std::uint64_t length = from.U64();
  const std::uint64_t start = from.U64();
  from.U64();
  const std::uint32_t crc = from.U32();
  if (op != mcap::Op::kFooter || length != 20 || from.rest != mcap::kMagic) return false;
  problem =
      "The recording's index is damaged, so the recording is read without it, up to the first "
      "damage.";
  if (start < opening.end || start > at || at - start > recording::kLargestSummary) return false;
  const std::string checked = file.Read(start, at + mcap::kHead + 16 - start);
  if (mcap::Crc(checked) != crc) return false;
  if (!ParseSummary(std::string_view(checked).substr(0, at - start), start)) return false;
  problem.clear();
  return true;
}

bool RecordingReader::Impl::ParseSummary(std::string_view summary, std::uint64_t start) {
  mcap::Parser from{summary};
  while (from.ok && !from.rest.empty()) {
    const auto op = from.Number<mcap::Op>();
    const std::uint64_t length = from.U64();
    mcap::Parser content{from.Take(length)};
    if (op == mcap::Op::kChunkIndex) {
      mcap::ChunkIndex index;
      if (!Parse(content.rest, &index) || index.offset < opening.end || index.offset > start ||
          index.length > start - index.offset)
        return false;
      chunks.push_back(std::move(index));
    } else if (op == mcap::Op::kStatistics) {
      content.Take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8);
      const auto messages_of = content.Offsets();
      const auto run = messages_of.find(recording::ChannelOf(TickGroup::kRun));
      if (!content.ok) return false;
      count = run == messages_of.end() ? 0 : run->second;
    }
  }
  return from.ok && count.has_value();
}

// Reads the chunks in order up to the first incomplete chunk.
void RecordingReader::Impl::Scan() {
  chunks.clear();
  count.reset();
  for (std::uint64_t at = opening.end; at < file.size();) {
    const auto head = ReadHead(file, at);
    if (!head || head->op == mcap::Op::kDataEnd) return;
    if (head->op == mcap::Op::kChunk) {
      auto index = ChunkAt(file, at);
      if (!index) return;
      chunks.push_back(std::move(*index));
    } else if (!IsBetweenChunks(file, at, *head)) {
      return;
    }
    at += mcap::kHead + head->length;
  }
}

// ---- ticks --------------------------------------------------------------------------------------

void RecordingReader::Impl::Load(std::size_t i) {
  rest = {};
  messages = ReadChunk(file, chunks[i]);
  rest = messages;
  chunk = i;
  next_chunk = i + 1;
  decoder = {};
}

bool RecordingReader::Impl::NextOf(TickRecord* record) {
  for (;;) {
    if (rest.empty()) {
      if (decoder.open()) file.Fail(chunks[chunk].offset, "This chunk ends within a tick.");
      if (next_chunk >= chunks.size()) return false;
      Load(next_chunk);
      continue;
    }
    Message message;
    const bool whole = TakeMessage(&rest, &message);
    const auto result = whole ? decoder.Take(message) : TickDecoder::Result::kBad;
    if (result == TickDecoder::Result::kBad) {
      rest = {};
      decoder = {};
      file.Fail(chunks[chunk].offset, "This chunk contains an invalid tick.");
    }
    if (result != TickDecoder::Result::kTick) continue;
    *record = decoder.record();
    return true;
  }
}

std::optional<std::uint64_t> RecordingReader::Impl::FirstTick(std::size_t i) {
  if (!first_ticks[i]) {
    const std::string bytes = ReadChunk(file, chunks[i]);
    std::string_view from = bytes;
    TickDecoder first;
    std::optional<std::uint64_t> tick;
    for (Message message; !tick && TakeMessage(&from, &message);)
      if (message.channel == recording::ChannelOf(TickGroup::kRun) &&
          first.Take(message) == TickDecoder::Result::kPart)
        tick = first.record().tick;
    first_ticks[i] = tick;
  }
  return *first_ticks[i];
}

// ---- events and snapshots -----------------------------------------------------------------------

void RecordingReader::Impl::TakeEvent(std::size_t i, const Message& message) {
  if (events.size() == kMaxLoggedEvents || event_bytes + message.data.size() > kMaxEventBytes) {
    ++more_events;
    return;
  }
  RecordingEvent event;
  event.unix_ns = message.time;
  if (message.data.size() > kLongestEvent || !recording::ParseEvent(message.data, &event))
    file.Fail(chunks[i].offset, "This chunk contains an invalid event.");
  event_bytes += message.data.size();
  events.push_back(std::move(event));
}

void RecordingReader::Impl::TakeHead(std::size_t i, const Message& message,
                                     std::vector<RecordedHead>* heads) const {
  if (heads->size() == kMaxHeads)
    file.Fail(chunks[i].offset, "The recording contains too many poses of the head.");
  const auto start = static_cast<std::uint64_t>(opening.header.start_unix_ns);
  RecordedHead head;
  if (message.time < start || message.data.size() > kLongestHead ||
      !recording::ParseHead(message.data, &head.head))
    file.Fail(chunks[i].offset, "This chunk contains an invalid pose of the head.");
  head.time = 1e-9 * static_cast<double>(message.time - start);
  heads->push_back(head);
}

void RecordingReader::Impl::TakeStream(std::size_t i, const Message& message,
                                       std::vector<RecordedStream>* streams) const {
  std::size_t stream = 0;
  std::string description;
  if (message.data.size() > kLongestSamples ||
      !recording::ParseDescription(message.data, &stream, &description))
    file.Fail(chunks[i].offset, "This chunk contains an invalid description of a stream.");
  if (streams->size() <= stream) streams->resize(stream + 1);
  (*streams)[stream].description = std::move(description);
}

void RecordingReader::Impl::TakeSamples(std::size_t i, const Message& message,
                                        std::vector<RecordedStream>* streams) const {
  const auto start = static_cast<std::uint64_t>(opening.header.start_unix_ns);
  const std::size_t stream =
      message.data.size() > kLongestSamples ? kMaxStreams : recording::StreamOf(message.data);
  const auto check = [&](bool good) {
    if (!good) file.Fail(chunks[i].offset, "This chunk contains invalid samples of a stream.");
  };
  check(message.time >= start && stream < kMaxStreams);
  // The chunk with the descriptions may be lost.
  if (streams->size() <= stream) streams->resize(stream + 1);
  RecordedStream& to = (*streams)[stream];
  std::size_t values = recording::kMaxSamplesInMessage * kMaxStreamChannels;
  for (const RecordedStream& one : *streams) values += one.values.size();
  to.complete = to.complete && values <= kMaxStreamValues;
  if (!to.complete) return;
  const double time = 1e-9 * static_cast<double>(message.time - start);
  check(recording::ParseSamples(message.data, stream, time, &to));
}

// Calls take(chunk, message) for each message of the channel.
template <class Take>
void RecordingReader::Impl::ForEachOn(std::uint16_t channel, const Take& take) const {
  if (channel == 0) return;  // also spares a truncated recording from being read completely
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (complete && !chunks[i].indexes.contains(channel)) continue;
    const std::string bytes = ReadChunk(file, chunks[i]);
    std::string_view from = bytes;
    for (Message message; TakeMessage(&from, &message);)
      if (message.channel == channel) take(i, message);
  }
}

void RecordingReader::Impl::FindOthersIn(std::size_t i) {
  const std::string bytes = ReadChunk(file, chunks[i]);
  std::string_view from = bytes;
  std::uint64_t ticks = 0;
  while (!from.empty()) {
    const std::uint64_t offset = bytes.size() - from.size();
    Message message;
    if (!TakeMessage(&from, &message))
      file.Fail(chunks[i].offset, "This chunk contains data that are not a message.");
    if (message.channel == recording::ChannelOf(TickGroup::kTiming)) ++ticks;
    if (message.channel == recording::kEventChannel) {
      TakeEvent(i, message);
    } else if (message.channel == recording::kSnapshotChannel) {
      recording::SnapshotView snapshot;
      if (snapshots.size() >= kMaxSnapshots || !recording::ParseSnapshot(message.data, &snapshot))
        file.Fail(chunks[i].offset, "This chunk contains an invalid saved state.");
      snapshots.push_back(snapshot.tick);
      places.push_back({i, offset});
    }
  }
  if (!complete) count = count.value_or(0) + ticks;
}

// Uses the index. If the recording is truncated, the function reads the whole recording.
void RecordingReader::Impl::FindOthers() {
  if (others_found) return;
  events.clear(), snapshots.clear(), places.clear();
  event_bytes = more_events = 0;
  if (!complete) count = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i)
    if (!complete || chunks[i].indexes.contains(recording::kEventChannel) ||
        chunks[i].indexes.contains(recording::kSnapshotChannel))
      FindOthersIn(i);
  others_found = true;
}

// ---- the whole file -----------------------------------------------------------------------------

// The message indexes after a chunk contain the positions of the chunk's messages.
void RecordingReader::Impl::CheckIndexes(const mcap::ChunkIndex& index) const {
  const std::string bytes = ReadChunk(file, index);
  std::map<std::uint16_t, std::string> expected;
  std::string_view from = bytes;
  while (!from.empty()) {
    const std::uint64_t offset = bytes.size() - from.size();
    Message message;
    if (!TakeMessage(&from, &message)) file.Fail(index.offset, "There is no message here.");
    mcap::Bytes entry;
    expected[message.channel] += entry.U64(message.time).U64(offset).text;
  }
  const std::uint64_t start = index.offset + index.length;
  std::uint64_t at = start;
  for (const auto& [channel, entries] : expected) {
    const auto it = index.indexes.find(channel);
    mcap::Bytes content;
    content.U16(channel).String(entries);
    const std::string record = mcap::Record(mcap::Op::kMessageIndex, content.text);
    if (it == index.indexes.end() || it->second != at || file.Read(at, record.size()) != record)
      file.Fail(at, "The index of the messages at this place is wrong.");
    at += record.size();
  }
  if (expected.size() != index.indexes.size() || at - start != index.indexes_length)
    file.Fail(at, "The index of the messages at this place is wrong.");
}

// ---- the interface ------------------------------------------------------------------------------

RecordingReader::RecordingReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
RecordingReader::~RecordingReader() = default;

const RecordingHeader& RecordingReader::header() const { return impl_->opening.header; }
bool RecordingReader::complete() const { return impl_->complete; }
const std::string& RecordingReader::problem() const { return impl_->problem; }
std::uint64_t RecordingReader::bytes() const { return impl_->file.size(); }

std::uint64_t RecordingReader::count() {
  if (!impl_->count || !impl_->complete) impl_->FindOthers();
  return impl_->count.value_or(0);
}

bool RecordingReader::Next(TickRecord* record) {
  if (impl_->pending) {
    *record = *impl_->pending;
    impl_->pending.reset();
    return true;
  }
  return impl_->NextOf(record);
}

void RecordingReader::Seek(std::uint64_t tick) {
  Impl& r = *impl_;
  r.pending.reset();
  r.rest = {};
  r.decoder = {};
  // Finds the last chunk that starts at or before `tick`. Chunks without ticks are skipped.
  std::size_t low = 0, high = r.chunks.size();
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    std::size_t with_ticks = middle;
    while (with_ticks < high && !r.FirstTick(with_ticks)) ++with_ticks;
    if (with_ticks == high || *r.FirstTick(with_ticks) > tick)
      high = middle;
    else
      low = with_ticks + 1;
  }
  r.next_chunk = low == 0 ? 0 : low - 1;
  TickRecord record;
  while (r.NextOf(&record)) {
    if (record.tick < tick) continue;
    r.pending = record;
    return;
  }
}

const std::vector<std::uint64_t>& RecordingReader::snapshots() {
  impl_->FindOthers();
  return impl_->snapshots;
}

bool RecordingReader::SnapshotAt(std::uint64_t tick, RecordedSnapshot* snapshot) {
  impl_->FindOthers();
  const auto& ticks = impl_->snapshots;
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < ticks.size(); ++k)
    if (ticks[k] <= tick && (!best || ticks[k] >= ticks[*best])) best = k;
  if (!best) return false;
  const Impl::SnapshotPlace place = impl_->places[*best];
  const std::string bytes = ReadChunk(impl_->file, impl_->chunks[place.chunk]);
  std::string_view from = std::string_view(bytes).substr(std::min(place.offset, bytes.size()));
  Message message;
  recording::SnapshotView view;
  if (!TakeMessage(&from, &message) || !recording::ParseSnapshot(message.data, &view))
    impl_->file.Fail(impl_->chunks[place.chunk].offset,
                     "The saved state is missing at this place.");
  const auto* data = reinterpret_cast<const std::byte*>(view.data.data());
  snapshot->tick = view.tick;
  snapshot->bytes.assign(data, data + view.data.size());
  return true;
}

const std::vector<RecordingEvent>& RecordingReader::events() {
  impl_->FindOthers();
  return impl_->events;
}

std::uint64_t RecordingReader::more_events() {
  impl_->FindOthers();
  return impl_->more_events;
}

std::vector<RecordingEvent> RecordingReader::gaps() {
  std::vector<RecordingEvent> gaps;
  for (const RecordingEvent& event : events())
    if (event.kind == "loss") gaps.push_back(event);
  return gaps;
}

std::vector<RecordedHead> RecordingReader::ReadHeads() const {
  const Impl& r = *impl_;
  std::vector<RecordedHead> heads;
  r.ForEachOn(recording::ChannelOf(r.opening.scene, kHeadTopic),
              [&](std::size_t i, const Message& message) { r.TakeHead(i, message, &heads); });
  std::ranges::stable_sort(heads, {}, &RecordedHead::time);
  return heads;
}

std::vector<RecordedStream> RecordingReader::ReadStreams() const {
  const Impl& r = *impl_;
  std::vector<RecordedStream> streams;
  r.ForEachOn(recording::ChannelOf(r.opening.scene, kStreamsTopic),
              [&](std::size_t i, const Message& message) { r.TakeStream(i, message, &streams); });
  r.ForEachOn(recording::ChannelOf(r.opening.scene, kSamplesTopic),
              [&](std::size_t i, const Message& message) { r.TakeSamples(i, message, &streams); });
  return streams;
}

void RecordingReader::Check() {
  const Impl& r = *impl_;
  if (!r.complete) r.file.Fail(r.file.size(), r.problem);
  if (r.opening.damaged) r.file.Fail(0, r.problem);
  std::uint64_t end = r.opening.end;
  for (const mcap::ChunkIndex& index : r.chunks) {
    if (index.offset != end)
      r.file.Fail(end, "The chunk that the index lists is missing at this place.");
    r.CheckIndexes(index);
    end += index.length + index.indexes_length;
    const auto next = ReadHead(r.file, end);
    if (next && next->op == mcap::Op::kAttachment && IsBetweenChunks(r.file, end, *next))
      end += mcap::kHead + next->length;
  }
  std::uint32_t crc = 0;
  for (std::uint64_t at = 0; at < end; at += kReadAtOnce)
    crc = mcap::Crc(r.file.Read(at, std::min(end - at, kReadAtOnce)), crc);
  if (r.file.Read(end, mcap::kHead + 4) !=
      mcap::Record(mcap::Op::kDataEnd, mcap::Bytes().U32(crc).text))
    r.file.Fail(end, "The recording is damaged: its checksum (CRC) is wrong.");
  RecordingReader again(r.file.path());
  std::uint64_t ticks = 0;
  for (TickRecord record; again.Next(&record);) ++ticks;
  if (ticks != r.count) r.file.Fail(end, "The recording's statistics are wrong.");
}

}  // namespace predictor
