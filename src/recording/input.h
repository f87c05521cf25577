// Reads untrusted files: records, chunks, messages, ticks. Never allocates memory for data that the
// file does not contain, or more memory than fixed limits allow.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/record.h"
#include "core/tick_fields.h"
#include "recording/mcap.h"

namespace predictor::recording {

inline constexpr std::uint64_t kLargestSummary = 64U << 20U;  // [bytes]

// A regular file. The file may change or shrink while it is being read.
class InputFile {
 public:
  // Throws InputError.
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  // Reads `n` bytes starting at `offset`. Throws InputError if the file does not contain them.
  std::string Read(std::uint64_t offset, std::uint64_t n) const;
  // Throws InputError that describes the problem at `offset`.
  [[noreturn]] void Fail(std::uint64_t offset, const std::string& sentence) const;

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

// The header of the record at `offset`. The header is plausible if the whole record fits into the
// file.
struct RecordHead {
  mcap::Op op = {};
  std::uint64_t length = 0;  // length of the content
};
std::optional<RecordHead> ReadHead(const InputFile& file, std::uint64_t offset);

// Finds, in order, the positions in the file at which a record may start. Each byte is read only
// once.
class MarkFinder {
 public:
  // Searches, before `farthest`, for records of type `op` that contain `mark` at `mark_at` bytes
  // after their start.
  MarkFinder(const InputFile& file, std::string mark, std::uint64_t mark_at, mcap::Op op,
             std::uint64_t farthest = ~std::uint64_t{0});

  // Returns the next start at `from` or later, or end() if there are no more.
  std::uint64_t Next(std::uint64_t from);
  std::uint64_t end() const { return end_; }

 private:
  void Load(std::uint64_t start);

  const InputFile& file_;
  const std::string mark_;
  const std::uint64_t mark_at_;
  const mcap::Op op_;
  const std::uint64_t end_;
  std::uint64_t start_ = 0;  // position of `bytes_` in the file
  std::string bytes_;
};

// Returns the part of the index of the chunk at `offset` that the chunk itself contains, without
// message indexes. Returns no value if there is no complete chunk of our format.
std::optional<mcap::ChunkIndex> ChunkAt(const InputFile& file, std::uint64_t offset);

// Returns a chunk's messages, uncompressed. Throws InputError that names the chunk and its offset
// if it does not match the index or its CRC is wrong.
std::string ReadChunk(const InputFile& file, const mcap::ChunkIndex& index);

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time = 0;  // [ns]
  std::string_view data;
};
// Removes the next message from `rest` and returns it in `message`. Returns false at the end or if
// the message is incomplete.
bool TakeMessage(std::string_view* rest, Message* message);

// Assembles a tick from its messages.
class TickDecoder {
 public:
  enum class Result { kOther, kPart, kTick, kBad };
  Result Take(const Message& message);
  const TickRecord& record() const { return record_; }
  bool open() const { return next_ != 0; }  // a tick has started and is not complete

 private:
  Result Decode(TickGroup group, const Message& message);

  TickRecord record_;
  int next_ = 0;            // group that may follow; 0: only the first group
  std::uint64_t time_ = 0;  // time of all its messages [ns]
  std::uint32_t crc_ = 0;
};

struct SnapshotView {
  std::uint64_t tick = 0;
  std::string_view data;
};
bool ParseSnapshot(std::string_view message, SnapshotView* snapshot);

}  // namespace predictor::recording
