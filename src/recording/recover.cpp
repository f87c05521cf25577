#include "recording/recover.h"

#include <zstd.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "recording/chunk.h"
#include "recording/encoder.h"
#include "recording/input.h"
#include "recording/mcap_file.h"
#include "recording/opening.h"
#include "recording/preamble.h"
#include "recording/reader.h"
#include "recording/writer.h"

namespace predictor {
namespace recording {
namespace {

// Among arbitrary bytes, a chunk is identified by the name of its compression. This name is kMarkAt
// bytes after the start of the chunk.
constexpr std::string_view kMark{"\4\0\0\0zstd", 8};
constexpr std::uint64_t kMarkAt = mcap::kHead + 8 + 8 + 8 + 4;
// The largest numbers of bytes that are read or decompressed without finding a valid chunk. A
// hostile file may contain many apparent chunks, each of which seems to contain the rest of the
// file.
constexpr std::uint64_t kMaxWasted = 2 * kLargestChunk, kMaxWastedPerByte = 16;  // [bytes]

// Returns the part of the chunk at `offset` (which ends before `end`) that can be decompressed,
// regardless of the length in its header.
std::string DecompressSome(const InputFile& file, std::uint64_t offset, std::uint64_t end) {
  const std::uint64_t start = offset + mcap::kHead + mcap::kChunkHead;
  if (start >= end) return {};
  const std::string compressed =
      file.Read(start, std::min<std::uint64_t>(end - start, kLargestChunk));
  std::string messages;
  ZSTD_DStream* stream = ZSTD_createDStream();
  ZSTD_DCtx_setParameter(stream, ZSTD_d_windowLogMax, 27);
  ZSTD_inBuffer in{compressed.data(), compressed.size(), 0};
  std::string part(ZSTD_DStreamOutSize(), '\0');
  for (std::size_t left = 1; left != 0 && messages.size() <= kLargestChunk;) {
    ZSTD_outBuffer out{part.data(), part.size(), 0};
    left = ZSTD_decompressStream(stream, &out, &in);
    if (ZSTD_isError(left) != 0) break;
    messages.append(part, 0, out.pos);
    if (out.pos == 0 && in.pos == in.size) break;
  }
  ZSTD_freeDStream(stream);
  return messages;
}

class Recovery {
 public:
  Recovery(const InputFile& in, const Opening& opening, bool person, McapFile* out)
      : in_(in),
        channels_(kEventChannel + opening.scene.size()),
        states_(ChannelOf(opening.scene, kPersonTopic)),
        heads_(ChannelOf(opening.scene, kHeadTopic)),
        streams_(ChannelOf(opening.scene, kStreamsTopic)),
        samples_(ChannelOf(opening.scene, kSamplesTopic)),
        person_(person),
        out_(out) {}

  RecoverReport Run(std::uint64_t at) {
    MarkFinder finder(in_, std::string(kMark), kMarkAt, mcap::Op::kChunk);
    while (at < in_.size()) {
      if (wasted_ > kMaxWasted + kMaxWastedPerByte * in_.size()) {
        report_.gave_up_at = at;
        break;
      }
      const auto head = ReadHead(in_, at);
      if (head && head->op == mcap::Op::kDataEnd && head->length == 4) break;
      if (head && IsBetweenChunks(in_, at, *head)) {
        at += mcap::kHead + head->length;
        continue;
      }
      const auto index = ChunkAt(in_, at);
      std::optional<std::string> messages;
      if (index) messages = Whole(*index);
      if (messages) {
        TakeAll(*messages);
        at += index->length;
      } else {
        const std::uint64_t next = finder.Next(at + 1);
        Salvage(at, next);
        at = next;
      }
    }
    return report_;
  }

 private:
  std::optional<std::string> Whole(const mcap::ChunkIndex& index) {
    try {
      return ReadChunk(in_, index);
    } catch (const InputError&) {
      wasted_ += index.length + index.uncompressed;
      return {};
    }
  }

  // Takes all messages of a chunk with a valid CRC.
  void TakeAll(const std::string& messages) {
    std::string_view rest = messages;
    Message message;
    while (TakeMessage(&rest, &message)) Take(message, true);
    ++report_.chunks;
    Flush();
  }

  // Takes the ticks with a valid CRC from a truncated or damaged chunk or from other bytes.
  void Salvage(std::uint64_t at, std::uint64_t end) {
    damage_ = true;
    if (in_.Read(at, 1)[0] != static_cast<char>(mcap::Op::kChunk)) return;
    ++report_.damaged_chunks;
    const std::string messages = DecompressSome(in_, at, end);
    std::string_view rest = messages;
    Message message;
    const std::uint64_t before = report_.ticks;
    while (TakeMessage(&rest, &message)) Take(message, false);
    if (report_.ticks == before) wasted_ += messages.size();
    report_.salvaged_ticks += report_.ticks - before;
    Flush();
    damage_ = true;
  }

  void Take(const Message& message, bool trusted) {
    if (message.channel == 0 || message.channel > channels_) return;
    switch (decoder_.Take(message)) {
      case TickDecoder::Result::kBad:
        decoder_ = {};
        parts_.clear();
        return;
      case TickDecoder::Result::kPart:
        parts_.emplace_back(message.channel, std::string(message.data));
        return;
      case TickDecoder::Result::kTick:
        parts_.emplace_back(message.channel, std::string(message.data));
        return TakeTick(message.time, trusted);
      case TickDecoder::Result::kOther:
        if (!trusted) return;
        if (!person_ && IsOfPerson(message)) {
          ++(message.channel == states_  ? report_.left_out_states
             : message.channel == heads_ ? report_.left_out_heads
             : IsOfStreams(message)      ? report_.left_out_samples
                                         : report_.left_out_markers);
          return;
        }
        report_.snapshots += message.channel == kSnapshotChannel;
        report_.events += message.channel == kEventChannel;
        builder_.Add(message.channel, message.sequence, message.time, message.data);
    }
  }

  bool IsOfStreams(const Message& message) const {
    return message.channel == streams_ || message.channel == samples_;
  }

  // Returns whether a message is a state, a head or another measurement of the person, or an event
  // with a text of a person or a program. All other messages are derived from the ticks.
  bool IsOfPerson(const Message& message) const {
    if (message.channel == states_ || message.channel == heads_ || IsOfStreams(message))
      return true;
    RecordingEvent event;
    return message.channel == kEventChannel && ParseEvent(message.data, &event) &&
           (event.kind == "marker" || event.kind == "event");
  }

  void TakeTick(std::uint64_t time, bool trusted) {
    const std::uint64_t tick = decoder_.record().tick;
    if (trusted || !last_ || tick > *last_) {
      NoteGap(tick, time, trusted);
      for (const auto& [channel, data] : parts_)
        builder_.Add(channel, static_cast<std::uint32_t>(tick), time, data);
      builder_.CountTick();
      ++report_.ticks;
      last_ = tick;
      damage_ = false;
    }
    parts_.clear();
  }

  // Records that ticks were lost by damage.
  void NoteGap(std::uint64_t tick, std::uint64_t time, bool trusted) {
    if ((trusted && !damage_) || !last_ || tick <= *last_ + 1) return;
    RecordingEvent event{tick, time, "loss", "", tick - *last_ - 1};
    event.text = std::to_string(event.lost) + " ticks are missing before this one: damaged";
    report_.lost_ticks += event.lost;
    builder_.Add(kEventChannel, 0, time, EventText(event));
  }

  void Flush() {
    decoder_ = {};
    parts_.clear();
    if (builder_.empty()) return;
    if (!out_->Put(builder_.Finish()))
      throw RecordingError(out_->path() + ": The recording could not be written: " + out_->error() +
                           ". Choose a disk with more space.");
  }

  const InputFile& in_;
  std::size_t channels_;
  std::uint16_t states_;             // channel of the person's states; 0: none
  std::uint16_t heads_;              // channel of the measured heads; 0: none
  std::uint16_t streams_, samples_;  // channels of other systems' streams; 0: none
  bool person_;
  McapFile* out_;
  RecoverReport report_;
  ChunkBuilder builder_;
  TickDecoder decoder_;
  // The messages of the tick that is not complete yet.
  std::vector<std::pair<std::uint16_t, std::string>> parts_;
  std::optional<std::uint64_t> last_;  // newest recovered tick
  bool damage_ = false;                // whether damage was found since the last tick
  std::uint64_t wasted_ = 0;           // bytes read or decompressed without result
};

bool IsIntact(const std::string& path) {
  try {
    RecordingReader(path).Check();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace
}  // namespace recording

RecoverReport Recover(const std::string& in, const std::string& out, FileCalls* calls,
                      const Rewriting& rewriting) {
  FileCalls real;
  const recording::InputFile file(in);
  recording::Opening opening = ReadOpening(file);
  if (rewriting.change) rewriting.change(&opening.header);
  recording::McapFile mended(out, recording::MakePreamble(opening.header, opening.scene),
                             calls ? calls : &real);
  RecoverReport report =
      recording::Recovery(file, opening, rewriting.person, &mended).Run(opening.end);
  if (!mended.End())
    throw RecordingError(out + ": The recording could not be written: " + mended.error() +
                         ". Choose a disk with more space.");
  report.was_complete = report.damaged_chunks == 0 && recording::IsIntact(in);
  report.preamble = opening.damage;
  return report;
}

std::string RecoverReport::Text() const {
  const auto count = [](std::uint64_t n, const char* what) {
    return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
  };
  if (was_complete) return "The recording was not damaged: " + count(ticks, "tick") + ".";
  std::string text = count(ticks, "tick") + (ticks == 1 ? " is" : " are") + " recovered, with " +
                     count(snapshots, "snapshot") + " and " + count(events, "event") + ".";
  if (damaged_chunks > 0)
    text += " " + count(damaged_chunks, "chunk") +
            (damaged_chunks == 1 ? " was truncated or damaged; " : " were truncated or damaged; ") +
            std::to_string(salvaged_ticks) + " of these ticks come from " +
            (damaged_chunks == 1 ? "it." : "them.");
  if (!preamble.empty()) text += " " + preamble;
  if (lost_ticks > 0)
    text += " " + count(lost_ticks, "tick") + " between the recovered ones " +
            (lost_ticks == 1 ? "is" : "are") + " lost.";
  if (gave_up_at > 0)
    text += " From byte " + std::to_string(gave_up_at) +
            " on, the file was not searched: too much of the preceding data only resembles chunks.";
  return text;
}

}  // namespace predictor
