#include "recording/chunk.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace predictor::recording {
namespace {

constexpr std::size_t kMessageHead = mcap::kHead + 2 + 4 + 8 + 8;
// Compression level 1 takes half the time of level 3. The chunks are only a few percent larger,
// because floating-point noise cannot be compressed.
constexpr int kLevel = 1;

}  // namespace

struct ChunkBuilder::Compressor {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ~Compressor() { ZSTD_freeCCtx(context); }
};

ChunkBuilder::ChunkBuilder() : compressor_(std::make_unique<Compressor>()) {}
ChunkBuilder::~ChunkBuilder() = default;

std::byte* ChunkBuilder::Begin(std::size_t most) {
  const std::size_t need = size_ + kMessageHead + most;
  if (records_.size() < need) records_.resize(std::max(need, 2 * records_.size()));
  return records_.data() + size_ + kMessageHead;
}

void ChunkBuilder::End(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                       std::size_t bytes) {
  if (size_ == 0) start_time_ = end_time_ = time_ns;
  start_time_ = std::min(start_time_, time_ns);
  end_time_ = std::max(end_time_, time_ns);
  indexes_[channel].emplace_back(time_ns, size_);
  std::byte* at = records_.data() + size_;
  const auto put = [&at](auto x) {
    std::memcpy(at, &x, sizeof x);
    at += sizeof x;
  };
  put(mcap::Op::kMessage);
  put(static_cast<std::uint64_t>(kMessageHead - mcap::kHead + bytes));
  put(channel);
  put(sequence);
  put(time_ns);  // time of recording
  put(time_ns);  // time of publication
  size_ += kMessageHead + bytes;
}

void ChunkBuilder::Add(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                       std::string_view message) {
  std::memcpy(Begin(message.size()), message.data(), message.size());
  End(channel, sequence, time_ns, message.size());
}

Chunk ChunkBuilder::Finish() {
  const std::string_view records(reinterpret_cast<const char*>(records_.data()), size_);
  std::string compressed(ZSTD_compressBound(size_), '\0');
  const std::size_t n = ZSTD_compressCCtx(compressor_->context, compressed.data(),
                                          compressed.size(), records.data(), size_, kLevel);
  if (ZSTD_isError(n) != 0)
    throw std::runtime_error(std::string("zstd could not compress a chunk: ") +
                             ZSTD_getErrorName(n));
  Chunk chunk;
  mcap::Bytes bytes;
  bytes.text.reserve(mcap::kHead + mcap::kChunkHead + n + 64 * 1024);
  bytes.Number(mcap::Op::kChunk).U64(mcap::kChunkHead + n);
  bytes.U64(start_time_).U64(end_time_).U64(size_).U32(mcap::Crc(records)).String(mcap::kZstd);
  bytes.U64(n).text.append(compressed, 0, n);
  chunk.index = {start_time_, end_time_, 0, bytes.text.size(), {}, 0, n, size_};
  for (const auto& [channel, entries] : indexes_) {
    if (entries.empty()) continue;
    chunk.index.indexes[channel] = bytes.text.size();
    chunk.messages[channel] = entries.size();
    bytes.Number(mcap::Op::kMessageIndex).U64(2 + 4 + 16 * entries.size());
    bytes.U16(channel).U32(static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time, offset] : entries) bytes.U64(time).U64(offset);
  }
  chunk.index.indexes_length = bytes.text.size() - chunk.index.length;
  chunk.bytes = std::move(bytes.text);
  chunk.ticks = ticks_;
  for (auto& [channel, entries] : indexes_) entries.clear();
  size_ = 0;
  ticks_ = 0;
  return chunk;
}

}  // namespace predictor::recording
