#include "recording/input.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include "core/error.h"
#include "recording/cdr.h"
#include "recording/encoder.h"

namespace predictor::recording {
namespace {

std::span<const std::byte> AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

}  // namespace

// ---- the file -----------------------------------------------------------------------------------

InputFile::InputFile(const std::string& path) : path_(path) {
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0)
    throw InputError(path, std::string("The recording cannot be read: ") + std::strerror(errno) +
                               ". Check the name and the permissions.");
  struct stat info {};
  if (::fstat(fd_, &info) != 0 || !S_ISREG(info.st_mode)) {
    ::close(fd_);
    throw InputError(path, "This is not a file. Give a recording (FILE.mcap).");
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

InputFile::~InputFile() { ::close(fd_); }

void InputFile::Fail(std::uint64_t offset, const std::string& sentence) const {
  throw InputError(path_ + ": byte " + std::to_string(offset), sentence);
}

std::string InputFile::Read(std::uint64_t offset, std::uint64_t n) const {
  if (offset > size_ || n > size_ - offset)
    Fail(offset, "The recording ends too early. `predictor repair` recovers the intact part.");
  std::string bytes(n, '\0');
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got =
        ::pread(fd_, bytes.data() + done, n - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      Fail(offset + done, std::string("Reading failed: ") +
                              (got < 0 ? std::strerror(errno) : "the file was shortened") +
                              ". Copy the file to another disk and try again.");
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

MarkFinder::MarkFinder(const InputFile& file, std::string mark, std::uint64_t mark_at, mcap::Op op,
                       std::uint64_t farthest)
    : file_(file),
      mark_(std::move(mark)),
      mark_at_(mark_at),
      op_(op),
      end_(std::min(farthest, file.size())) {}

std::uint64_t MarkFinder::Next(std::uint64_t from) {
  std::uint64_t at = from + mark_at_;  // position of the mark
  while (at + mark_.size() <= end_) {
    if (at < start_ + mark_at_ || at + mark_.size() > start_ + bytes_.size()) Load(at - mark_at_);
    for (std::size_t k = bytes_.find(mark_, at - start_); k != std::string::npos;
         k = bytes_.find(mark_, k + 1))
      if (bytes_[k - mark_at_] == static_cast<char>(op_)) return start_ + k - mark_at_;
    at = start_ + bytes_.size() - mark_.size() + 1;
  }
  return end_;
}

void MarkFinder::Load(std::uint64_t start) {
  constexpr std::uint64_t kSearchAtOnce = 1U << 20U;  // [bytes]
  start_ = start;
  bytes_ = file_.Read(start, std::min(kSearchAtOnce, end_ - start));
}

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
    file.Fail(index.offset,
              "This chunk " + why + ". `predictor repair` recovers the other chunks.");
  };
  if (index.length < mcap::kHead + mcap::kChunkHead ||
      index.length > ZSTD_compressBound(kLargestChunk) + mcap::kHead + mcap::kChunkHead)
    fail("has an impossible size");
  const std::string bytes = file.Read(index.offset, index.length);
  mcap::Parser from{bytes};
  const auto op = from.Number<mcap::Op>();
  const std::uint64_t length = from.U64();
  const auto head = ParseChunkHead(from.rest);
  if (op != mcap::Op::kChunk || length != index.length - mcap::kHead || !head ||
      head->compressed != length - mcap::kChunkHead || head->compressed != index.compressed ||
      head->uncompressed != index.uncompressed || head->start_time != index.start_time ||
      head->end_time != index.end_time)
    fail("does not match the index");
  // The uncompressed size is checked before memory is allocated for the contents.
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

// Returns whether `hand` is valid as an index of a side: left, right, or neither.
bool IsSide(std::int8_t hand) { return hand >= -1 && hand < kHands; }
bool MayBeOmitted(TickGroup group) {
  return group == TickGroup::kInputs || group == TickGroup::kLeft || group == TickGroup::kRight ||
         group == TickGroup::kMovables;
}
bool HasSides(const TickRecord& r) {
  return IsSide(r.cause_hand) && IsSide(r.read.hand) && IsSide(r.written.hand) &&
         IsSide(r.harder.hand);
}

}  // namespace

TickDecoder::Result TickDecoder::Decode(TickGroup group, const Message& message) {
  CdrReader reader(AsBytes(message.data));
  VisitGroup(group, reader, record_);
  crc_ = mcap::Crc(message.data.substr(0, reader.used()), crc_);
  if (group == TickGroup::kTiming) {
    std::uint32_t crc = 0;
    reader.Get(crc);
    if (crc != crc_) return Result::kBad;
  }
  if (!reader.Done() || message.sequence != static_cast<std::uint32_t>(record_.tick) ||
      !HasSides(record_))
    return Result::kBad;
  next_ = group == TickGroup::kTiming ? 0 : static_cast<int>(group) + 1;
  return group == TickGroup::kTiming ? Result::kTick : Result::kPart;
}

TickDecoder::Result TickDecoder::Take(const Message& message) {
  const int g = message.channel - 1;
  if (g < 0 || g >= kTickGroupCount) return next_ == 0 ? Result::kOther : Result::kBad;
  const auto group = static_cast<TickGroup>(g);
  if ((group == TickGroup::kRun) != (next_ == 0) || g < next_) return Result::kBad;
  for (int skipped = next_; skipped < g; ++skipped)
    if (!MayBeOmitted(static_cast<TickGroup>(skipped))) return Result::kBad;
  if (group == TickGroup::kRun) {
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
  reader.Get(snapshot->tick);
  reader.Get(size);
  if (!reader.ok() || message.size() - reader.used() != size) return false;
  snapshot->data = message.substr(reader.used());
  return true;
}

}  // namespace predictor::recording
