#include "recording/mcap.h"

#include <libdeflate.h>

namespace predictor::mcap {

std::uint32_t Crc(std::string_view bytes, std::uint32_t before) {
  if (bytes.empty()) return before;  // otherwise a null pointer would restart the CRC
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

Bytes& Bytes::Strings(const Map& map) {
  Bytes inner;
  for (const auto& [key, value] : map) inner.String(key).String(value);
  return String(inner.text);
}

Bytes& Bytes::Offsets(const std::map<std::uint16_t, std::uint64_t>& map) {
  Bytes inner;
  for (const auto& [key, value] : map) inner.U16(key).U64(value);
  return String(inner.text);
}

std::string Record(Op op, std::string_view content) {
  Bytes record;
  record.text.reserve(kHead + content.size());
  record.Number(static_cast<std::uint8_t>(op)).U64(content.size());
  record.text += content;
  return std::move(record.text);
}

Map Parser::Strings() {
  constexpr std::size_t kMaxEntries = 10'000;  // limit, because each entry takes far more memory
                                               // than space in the file
  Map map;
  Parser inner{String()};
  while (ok && !inner.rest.empty()) {
    const std::string key(inner.String());
    const std::string value(inner.String());
    ok = inner.ok && map.size() < kMaxEntries;
    if (ok) map[key] = value;
  }
  return map;
}

std::map<std::uint16_t, std::uint64_t> Parser::Offsets() {
  std::map<std::uint16_t, std::uint64_t> map;
  Parser inner{String()};
  while (ok && !inner.rest.empty()) {
    const std::uint16_t key = inner.U16();
    const std::uint64_t value = inner.U64();
    ok = inner.ok;
    if (ok) map[key] = value;
  }
  return map;
}

std::string ToRecord(const ChunkIndex& index) {
  Bytes content;
  content.U64(index.start_time).U64(index.end_time).U64(index.offset).U64(index.length);
  content.Offsets(index.indexes).U64(index.indexes_length).String(kZstd);
  content.U64(index.compressed).U64(index.uncompressed);
  return Record(Op::kChunkIndex, content.text);
}

bool Parse(std::string_view content, ChunkIndex* index) {
  Parser from{content};
  index->start_time = from.U64();
  index->end_time = from.U64();
  index->offset = from.U64();
  index->length = from.U64();
  index->indexes = from.Offsets();
  index->indexes_length = from.U64();
  const bool zstd = from.String() == kZstd;
  index->compressed = from.U64();
  index->uncompressed = from.U64();
  return from.ok && zstd;
}

std::string ToRecord(const Attachment& attachment) {
  Bytes content;
  content.U64(attachment.log_time).U64(attachment.log_time);
  content.String(attachment.name).String(attachment.media_type);
  content.U64(attachment.data.size());
  content.text += attachment.data;
  content.U32(Crc(content.text));
  return Record(Op::kAttachment, content.text);
}

std::string IndexOf(const Attachment& attachment) {
  Bytes index;
  index.U64(attachment.log_time).U64(attachment.log_time).U64(attachment.data.size());
  index.String(attachment.name).String(attachment.media_type);
  return index.text;
}

}  // namespace predictor::mcap
