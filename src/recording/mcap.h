// Reads and writes the records of the container format MCAP as bytes. The format is specified at
// https://mcap.dev/spec.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace predictor::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::size_t kHead = 9;  // header of a record: opcode and length
inline constexpr std::size_t kFooterBytes = kHead + 20 + 8;  // including the final magic

enum class Op : std::uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kAttachment,
  kAttachmentIndex,
  kStatistics,
  kMetadata,
  kMetadataIndex,
  kSummaryOffset,
  kDataEnd,
};

using Map = std::map<std::string, std::string>;

// Returns the CRC of `bytes`, continued from the CRC of the preceding data.
std::uint32_t Crc(std::string_view bytes, std::uint32_t before = 0);

// Builds a sequence of bytes.
class Bytes {
 public:
  template <class T>
  Bytes& Number(T x) {
    char raw[sizeof(T)];
    std::memcpy(raw, &x, sizeof(T));
    text.append(raw, sizeof(T));
    return *this;
  }
  Bytes& U16(std::uint16_t x) { return Number(x); }
  Bytes& U32(std::uint32_t x) { return Number(x); }
  Bytes& U64(std::uint64_t x) { return Number(x); }
  Bytes& String(std::string_view x) {
    U32(static_cast<std::uint32_t>(x.size()));
    text += x;
    return *this;
  }
  Bytes& Strings(const Map& map);
  Bytes& Offsets(const std::map<std::uint16_t, std::uint64_t>& map);

  std::string text;
};

// Returns a complete record.
std::string Record(Op op, std::string_view content);

// Parses untrusted bytes. The member `ok` is false from the first missing byte on, and no memory is
// allocated for missing data.
struct Parser {
  std::string_view rest;
  bool ok = true;

  std::string_view Take(std::uint64_t n) {
    if (!ok || n > rest.size()) {
      ok = false;
      return {};
    }
    const std::string_view taken = rest.substr(0, n);
    rest.remove_prefix(n);
    return taken;
  }
  template <class T>
  T Number() {
    T x{};
    const std::string_view raw = Take(sizeof(T));
    if (ok) std::memcpy(&x, raw.data(), sizeof(T));
    return x;
  }
  std::uint16_t U16() { return Number<std::uint16_t>(); }
  std::uint32_t U32() { return Number<std::uint32_t>(); }
  std::uint64_t U64() { return Number<std::uint64_t>(); }
  std::string_view String() { return Take(U32()); }
  Map Strings();
  std::map<std::uint16_t, std::uint64_t> Offsets();
};

// The offset and the contents of a chunk.
struct ChunkIndex {
  std::uint64_t start_time = 0, end_time = 0;      // times of its messages [ns]
  std::uint64_t offset = 0, length = 0;            // position of the chunk's record in the file
  std::map<std::uint16_t, std::uint64_t> indexes;  // channel -> offset of its message index
  std::uint64_t indexes_length = 0;                // total length of the message indexes
  std::uint64_t compressed = 0, uncompressed = 0;  // size of its messages in bytes
  bool operator==(const ChunkIndex&) const = default;
};
std::string ToRecord(const ChunkIndex& index);
bool Parse(std::string_view content, ChunkIndex* index);

// The header of a chunk's record, without the messages.
struct ChunkHead {
  std::uint64_t start_time = 0, end_time = 0, uncompressed = 0;
  std::uint32_t crc = 0;  // CRC of the uncompressed data
  std::string_view compression;
  std::uint64_t compressed = 0;
};
inline constexpr std::string_view kZstd = "zstd";
inline constexpr std::size_t kChunkHead = 8 + 8 + 8 + 4 + 4 + 4 + 8;  // compressed by zstd

struct Attachment {
  std::string name, media_type;
  std::uint64_t log_time = 0;
  std::string data;
};
std::string ToRecord(const Attachment& attachment);  // including its CRC
std::string IndexOf(const Attachment& attachment);   // excluding the record's offset and length

}  // namespace predictor::mcap
