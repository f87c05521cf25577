// Reading what a stranger may have written: records, chunks, messages, ticks. Nothing is allocated
// for what the file does not hold, nor above fixed bounds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/record.h"
#include "recording/fields.h"
#include "recording/mcap.h"

namespace predictor::recording {

inline constexpr std::uint64_t kLargestSummary = 64U << 20U;  // [bytes]

// A regular file. It may change or shrink while it is read.
class InputFile {
 public:
  // Throws InputError.
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  // `n` bytes from `offset` on. Throws InputError if they are not there.
  std::string Read(std::uint64_t offset, std::uint64_t n) const;
  // InputError: what is wrong at `offset`.
  [[noreturn]] void Fail(std::uint64_t offset, const std::string& sentence) const;

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

// What the record's head at `offset` says, as far as it can be: opcode and length fit into the
// file.
struct RecordHead {
  mcap::Op op = {};
  std::uint64_t length = 0;  // of the content
};
std::optional<RecordHead> ReadHead(const InputFile& file, std::uint64_t offset);

// Finds the places where a record may begin, on and on; each byte is read once.
class MarkFinder {
 public:
  // Of records `op` that have `mark` `mark_at` bytes behind their start, before `farthest`.
  MarkFinder(const InputFile& file, std::string mark, std::uint64_t mark_at, mcap::Op op,
             std::uint64_t farthest = ~std::uint64_t{0});

  // The next at `from` or later; end() if there is none.
  std::uint64_t Next(std::uint64_t from);
  std::uint64_t end() const { return end_; }

 private:
  void Load(std::uint64_t start);

  const InputFile& file_;
  const std::string mark_;
  const std::uint64_t mark_at_;
  const mcap::Op op_;
  const std::uint64_t end_;
  std::uint64_t start_ = 0;  // of `bytes_`
  std::string bytes_;
};

// The index of the chunk at `offset`, as far as the chunk itself tells (no message indexes);
// nothing if none of ours lies there whole.
std::optional<mcap::ChunkIndex> ChunkAt(const InputFile& file, std::uint64_t offset);

// A chunk's messages, uncompressed. Throws InputError that names the chunk and its offset if it is
// not what the index says, or its CRC is wrong.
std::string ReadChunk(const InputFile& file, const mcap::ChunkIndex& index);

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time = 0;  // [ns]
  std::string_view data;
};
// Takes the next message from `rest`; false at the end, or if there is none whole.
bool TakeMessage(std::string_view* rest, Message* message);

// Puts a tick together out of its messages.
class TickDecoder {
 public:
  enum class Result { kOther, kPart, kTick, kBad };
  Result Take(const Message& message);
  const TickRecord& record() const { return record_; }
  bool open() const { return next_ != 0; }  // a tick has begun and is not whole

 private:
  Result Decode(Group group, const Message& message);

  TickRecord record_;
  int next_ = 0;            // group that may come next; 0: only the first
  std::uint64_t time_ = 0;  // of all its messages [ns]
  std::uint32_t crc_ = 0;
};

struct SnapshotView {
  std::uint64_t tick = 0;
  std::string_view data;
};
bool ParseSnapshot(std::string_view message, SnapshotView* snapshot);

}  // namespace predictor::recording
