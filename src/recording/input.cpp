#include "recording/input.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <span>

#include "core/error.h"
#include "core/text.h"
#include "recording/cdr.h"
#include "recording/encoder.h"
#include "recording/schema.h"

namespace predictor::recording {
namespace {

std::span<const std::byte> AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

template <class T>
bool ParseNumber(const std::string& text, T* x) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *x);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

// ---- the file -----------------------------------------------------------------------------------

InputFile::InputFile(const std::string& path) : path_(path) {
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0)
    throw InputError(path, std::string("The recording cannot be read: ") + std::strerror(errno) +
                               ". Check the name and that you may read it.");
  struct stat info {};
  if (::fstat(fd_, &info) != 0 || !S_ISREG(info.st_mode)) {
    ::close(fd_);
    throw InputError(path, "This is no file. Name a recording (FILE.mcap).");
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

InputFile::~InputFile() { ::close(fd_); }

void InputFile::Fail(std::uint64_t offset, const std::string& sentence) const {
  throw InputError(path_ + ": byte " + std::to_string(offset), sentence);
}

std::string InputFile::Read(std::uint64_t offset, std::uint64_t n) const {
  if (offset > size_ || n > size_ - offset)
    Fail(offset, "The recording ends too early. `predictor recover` keeps what is whole.");
  std::string bytes(n, '\0');
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got =
        ::pread(fd_, bytes.data() + done, n - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      Fail(offset + done, std::string("Reading failed: ") +
                              (got < 0 ? std::strerror(errno) : "the file became shorter") +
                              ". Copy it to another disk and try again.");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

std::optional<RecordHead> ReadHead(const InputFile& file, std::uint64_t offset) {
  if (offset > file.size() || file.size() - offset < mcap::kHead) return {};
  const std::string bytes = file.Read(offset, mcap::kHead);
  mcap::Parser from{bytes};
  RecordHead head;
  head.op = from.Number<mcap::Op>();
  head.length = from.U64();
  if (head.length > file.size() - offset - mcap::kHead) return {};
  return head;
}

bool IsMessageIndex(const InputFile& file, std::uint64_t offset, const RecordHead& head) {
  constexpr std::uint64_t kBeforeEntries = 2 + 4;
  if (head.op != mcap::Op::kMessageIndex || head.length < kBeforeEntries) return false;
  const std::string bytes = file.Read(offset + mcap::kHead, kBeforeEntries);
  mcap::Parser from{bytes};
  from.U16();
  return head.length == kBeforeEntries + from.U32();
}

// ---- before the first chunk ---------------------------------------------------------------------

namespace {

// Collects the records before the first chunk.
class OpeningReader {
 public:
  explicit OpeningReader(const InputFile& file) : file_(file) {}

  Opening Read() {
    const std::uint64_t most = mcap::kMagic.size();
    if (file_.size() < most || file_.Read(0, most) != mcap::kMagic)
      file_.Fail(0, "This is no recording: an MCAP file begins otherwise.");
    bytes_ = mcap::kMagic;
    std::string record;
    std::size_t records = 0;
    while (!done_) {
      const std::uint64_t at = bytes_.size();
      const auto head = ReadHead(file_, at);
      if (!head) Damaged(at);
      if (at + head->length > kLargestPreamble || ++records > kMostPreambleRecords)
        file_.Fail(at, "There is more before the first tick than a recording of this program has.");
      record = file_.Read(at, mcap::kHead + head->length);
      Take(head->op, record, at);
      if (!done_) bytes_ += record;
    }
    opening_.end = bytes_.size() + record.size();
    opening_.preamble.bytes = std::move(bytes_) + record;
    CheckTopics();
    return std::move(opening_);
  }

 private:
  [[noreturn]] void Damaged(std::uint64_t at) const {
    file_.Fail(at,
               "The recording is cut or damaged before its first tick: nothing of it can be "
               "read.");
  }

  void Take(mcap::Op op, const std::string& record, std::uint64_t at) {
    mcap::Parser from{std::string_view(record).substr(mcap::kHead)};
    switch (op) {
      case mcap::Op::kHeader:
        from.String();
        if (from.String() != "predictor" || !from.ok)
          file_.Fail(at, "This MCAP file is not a recording of this program.");
        return;
      case mcap::Op::kSchema:
        return TakeSchema(record, from, at);
      case mcap::Op::kChannel:
        return TakeChannel(record, from, at);
      case mcap::Op::kAttachment:
        return TakeAttachment(record, from, at);
      case mcap::Op::kMetadata:
        return TakeMetadata(record, from, at);
      default:
        Damaged(at);
    }
  }

  void TakeSchema(const std::string& record, mcap::Parser from, std::uint64_t at) {
    const std::uint16_t id = from.U16();
    from.String(), from.String();
    const std::string text(from.String());
    if (!from.ok) Damaged(at);
    schemas_[id] = text;
    opening_.preamble.schemas.push_back(record);
  }
  void TakeChannel(const std::string& record, mcap::Parser from, std::uint64_t at) {
    const std::uint16_t id = from.U16();
    const std::uint16_t schema = from.U16();
    const std::string topic(from.String());
    if (!from.ok) Damaged(at);
    topics_[id] = {topic, schema};
    opening_.preamble.channels.push_back(record);
  }

  void TakeAttachment(const std::string& record, mcap::Parser from, std::uint64_t at) {
    const std::uint64_t log_time = from.U64();
    from.U64();
    const std::string name(from.String()), media_type(from.String());
    const std::uint64_t size = from.U64();
    const std::string data(from.Take(size));
    if (!from.ok) Damaged(at);
    mcap::Bytes index;
    index.U64(at).U64(record.size()).U64(log_time).U64(log_time).U64(size);
    index.String(name).String(media_type);
    opening_.preamble.attachment_indexes += mcap::Record(mcap::Op::kAttachmentIndex, index.text);
    ++opening_.preamble.attachments;
    if (name == kScenarioFile)
      opening_.header.scenario_yaml = data;
    else if (name == kMachineFile)
      opening_.header.machine_yaml = data;
    else
      opening_.header.attachments.push_back({name, media_type, data});
  }

  void TakeMetadata(const std::string& record, mcap::Parser from, std::uint64_t at) {
    const std::string name(from.String());
    const mcap::Map map = from.Strings();
    if (!from.ok || !from.rest.empty()) Damaged(at);  // its length is not under the CRC
    mcap::Bytes index;
    index.U64(at).U64(record.size()).String(name);
    opening_.preamble.metadata_indexes += mcap::Record(mcap::Op::kMetadataIndex, index.text);
    ++opening_.preamble.metadata;
    if (name == kRunMetadata) TakeRun(map, at);
    if (name == kLabelMetadata) opening_.header.labels = map;
    if (name == kModelMetadata) opening_.header.model_hashes = map;
    if (name != kPreambleMetadata) return;
    if (map != mcap::Map{{"bytes", std::to_string(bytes_.size())},
                         {"crc32", std::to_string(mcap::Crc(bytes_))}})
      file_.Fail(at,
                 "What stands before the recording's first tick is damaged (its CRC is "
                 "wrong).");
    done_ = true;
  }
  void TakeRun(const mcap::Map& map, std::uint64_t at) {
    const auto text = [&map](const char* key) {
      const auto it = map.find(key);
      return it == map.end() ? std::string() : it->second;
    };
    RecordingHeader& header = opening_.header;
    header.scenario_name = text("scenario");
    header.program_version = text("version");
    if (text("format") != kFormat)
      file_.Fail(at, "The recording has format " + Quote(text("format")) +
                         ", this program reads format " + kFormat +
                         ". Use the program that "
                         "recorded it (version " +
                         Quote(header.program_version) + ").");
    if (!ParseNumber(text("seed"), &header.seed) || !ParseNumber(text("dt"), &header.dt) ||
        !ParseNumber(text("start_unix_ns"), &header.start_unix_ns))
      Damaged(at);
    if (!(header.dt >= kShortestTick && header.dt <= kLongestTick))
      file_.Fail(at, "The recording says that its ticks last " + text("dt") +
                         " s. They last 0.0001 to 1 s: the file is damaged or made up, and cannot "
                         "be read.");
  }

  // Its ticks are what this program's ticks are.
  void CheckTopics() {
    for (int g = 0; g < kGroups; ++g) {
      const auto group = static_cast<Group>(g);
      Expect(ChannelOf(group), kGroupNames[static_cast<std::size_t>(g)].topic, Definition(group));
    }
    Expect(kSnapshotChannel, kSnapshotTopic, kSnapshotDefinition);
    Expect(kEventChannel, kEventsTopic, EventSchema());
  }
  void Expect(std::uint16_t channel, const std::string& topic, const std::string& definition) {
    const auto it = topics_.find(channel);
    if (it != topics_.end() && it->second.first == topic) {
      const std::string& text = schemas_[it->second.second];
      if (text == definition || Layout(text) == Layout(definition)) return;
    }
    file_.Fail(0, "The recording's topic " + topic +
                      " has other fields than this program's. Use "
                      "the program that recorded it (version " +
                      Quote(opening_.header.program_version) + ").");
  }

  const InputFile& file_;
  Opening opening_;
  std::string bytes_;  // so far
  bool done_ = false;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::pair<std::string, std::uint16_t>> topics_;
};

}  // namespace

Opening ReadOpening(const InputFile& file) { return OpeningReader(file).Read(); }

// ---- chunks -------------------------------------------------------------------------------------

namespace {

std::optional<mcap::ChunkHead> ParseChunkHead(std::string_view content) {
  mcap::Parser from{content};
  mcap::ChunkHead head;
  head.start_time = from.U64();
  head.end_time = from.U64();
  head.uncompressed = from.U64();
  head.crc = from.U32();
  head.compression = from.String();
  head.compressed = from.U64();
  if (!from.ok || head.compression != mcap::kZstd || head.uncompressed > kLargestChunk) return {};
  return head;
}

}  // namespace

std::optional<mcap::ChunkIndex> ChunkAt(const InputFile& file, std::uint64_t offset) {
  const auto head = ReadHead(file, offset);
  if (!head || head->op != mcap::Op::kChunk || head->length < mcap::kChunkHead) return {};
  const std::string content = file.Read(offset + mcap::kHead, mcap::kChunkHead);
  const auto chunk = ParseChunkHead(content);
  if (!chunk || chunk->compressed != head->length - mcap::kChunkHead ||
      chunk->compressed > ZSTD_compressBound(kLargestChunk))
    return {};
  return mcap::ChunkIndex{
      chunk->start_time, chunk->end_time,    offset, mcap::kHead + head->length, {}, 0,
      chunk->compressed, chunk->uncompressed};
}

std::string ReadChunk(const InputFile& file, const mcap::ChunkIndex& index) {
  const auto fail = [&](const std::string& why) {
    file.Fail(index.offset, "The chunk here " + why + ". `predictor recover` keeps the others.");
  };
  if (index.length < mcap::kHead + mcap::kChunkHead ||
      index.length > ZSTD_compressBound(kLargestChunk) + mcap::kHead + mcap::kChunkHead)
    fail("is not of a possible size");
  const std::string bytes = file.Read(index.offset, index.length);
  mcap::Parser from{bytes};
  const auto op = from.Number<mcap::Op>();
  const std::uint64_t length = from.U64();
  const auto head = ParseChunkHead(from.rest);
  if (op != mcap::Op::kChunk || length != index.length - mcap::kHead || !head ||
      head->compressed != length - mcap::kChunkHead || head->compressed != index.compressed ||
      head->uncompressed != index.uncompressed || head->start_time != index.start_time ||
      head->end_time != index.end_time)
    fail("is not what the index says");
  // Before memory is taken for it.
  if (ZSTD_getFrameContentSize(bytes.data() + mcap::kHead + mcap::kChunkHead, head->compressed) !=
      head->uncompressed)
    fail("cannot be decompressed");
  std::string messages(head->uncompressed, '\0');
  const std::size_t n =
      ZSTD_decompress(messages.data(), messages.size(),
                      bytes.data() + mcap::kHead + mcap::kChunkHead, head->compressed);
  if (ZSTD_isError(n) != 0 || n != messages.size()) fail("cannot be decompressed");
  if (mcap::Crc(messages) != head->crc) fail("is damaged: its CRC is wrong");
  return messages;
}

bool TakeMessage(std::string_view* rest, Message* message) {
  mcap::Parser from{*rest};
  const auto op = from.Number<mcap::Op>();
  const std::uint64_t length = from.U64();
  mcap::Parser content{from.Take(length)};
  message->channel = content.U16();
  message->sequence = content.U32();
  message->time = content.U64();
  content.U64();
  message->data = content.rest;
  if (!from.ok || !content.ok || op != mcap::Op::kMessage) return false;
  *rest = from.rest;
  return true;
}

// ---- ticks --------------------------------------------------------------------------------------

namespace {

// Sides are what others index by: left, right, or neither.
bool IsSide(std::int8_t hand) { return hand >= -1 && hand < kHands; }
bool HasSides(const TickRecord& r) {
  return IsSide(r.cause_hand) && IsSide(r.read.hand) && IsSide(r.written.hand);
}

}  // namespace

TickDecoder::Result TickDecoder::Decode(Group group, const Message& message) {
  CdrReader reader(AsBytes(message.data));
  VisitGroup(group, reader, record_);
  crc_ = mcap::Crc(message.data.substr(0, reader.used()), crc_);
  if (group == Group::kTiming) {
    std::uint32_t crc = 0;
    reader.Value("record_crc", crc);
    if (crc != crc_) return Result::kBad;
  }
  if (!reader.Done() || message.sequence != static_cast<std::uint32_t>(record_.tick) ||
      !HasSides(record_))
    return Result::kBad;
  next_ = group == Group::kTiming ? 0 : static_cast<int>(group) + 1;
  return group == Group::kTiming ? Result::kTick : Result::kPart;
}

TickDecoder::Result TickDecoder::Take(const Message& message) {
  const int g = message.channel - 1;
  if (g < 0 || g >= kGroups) return next_ == 0 ? Result::kOther : Result::kBad;
  const auto group = static_cast<Group>(g);
  if ((group == Group::kRun) != (next_ == 0) || g < next_) return Result::kBad;
  // Only what may be absent is left out.
  for (int skipped = next_; skipped < g; ++skipped)
    if (skipped != static_cast<int>(Group::kInputs) && skipped != static_cast<int>(Group::kLeft) &&
        skipped != static_cast<int>(Group::kRight))
      return Result::kBad;
  if (group == Group::kRun) {
    std::memset(static_cast<void*>(&record_), 0, sizeof record_);
    record_.inputs.fill(RunInput{});
    time_ = message.time;
    crc_ = CrcOf(time_);
  }
  if (message.time != time_) return Result::kBad;
  return Decode(group, message);
}

bool ParseSnapshot(std::string_view message, SnapshotView* snapshot) {
  CdrReader reader(AsBytes(message));
  std::uint32_t size = 0;
  reader.Value("tick", snapshot->tick);
  reader.Value("data", size);
  if (!reader.ok() || message.size() - reader.used() != size) return false;
  snapshot->data = message.substr(reader.used());
  return true;
}

}  // namespace predictor::recording
