// Collects messages into a chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "recording/mcap.h"

namespace predictor::recording {

// A chunk with its message indexes, ready to be appended to a file. The offsets of the message
// indexes in `index` are relative to the chunk's start until the chunk is placed in the file.
struct Chunk {
  std::string bytes;
  mcap::ChunkIndex index;
  std::map<std::uint16_t, std::uint64_t> messages;  // channel -> number of messages
  std::uint64_t ticks = 0;
};

class ChunkBuilder {
 public:
  ChunkBuilder();
  ~ChunkBuilder();
  ChunkBuilder(const ChunkBuilder&) = delete;
  ChunkBuilder& operator=(const ChunkBuilder&) = delete;

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }  // uncompressed size [bytes]
  std::uint64_t start_time() const { return start_time_; }

  // Returns space for a message of at most `most` bytes. The caller writes the message into this
  // space and then reports the message's length.
  std::byte* Begin(std::size_t most);
  void End(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns, std::size_t bytes);
  void Add(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
           std::string_view message);
  void CountTick() { ++ticks_; }

  // Returns the collected messages, compressed, and starts a new collection. Throws
  // std::runtime_error if zstd fails.
  Chunk Finish();

 private:
  struct Compressor;
  std::unique_ptr<Compressor> compressor_;
  std::vector<std::byte> records_;  // the first size_ bytes are in use
  std::size_t size_ = 0;
  std::uint64_t start_time_ = 0, end_time_ = 0, ticks_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> indexes_;
};

}  // namespace predictor::recording
