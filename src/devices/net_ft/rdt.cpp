#include "devices/net_ft/rdt.h"

#include "devices/wire/bytes.h"

namespace predictor::rdt {
namespace {

constexpr std::uint16_t kHeader = 0x1234;

}  // namespace

std::array<std::byte, kRequestBytes> Encode(const Request& request) noexcept {
  std::array<std::byte, kRequestBytes> bytes{};
  BigEndianWriter writer(bytes);
  writer.Put(kHeader);
  writer.Put(static_cast<std::uint16_t>(request.command));
  writer.Put(request.count);
  return bytes;
}

std::array<std::byte, kRecordBytes> Encode(const Record& record) noexcept {
  std::array<std::byte, kRecordBytes> bytes{};
  BigEndianWriter writer(bytes);
  writer.Put(record.sequence);
  writer.Put(record.sample);
  writer.Put(record.status);
  for (const std::int32_t count : record.counts) writer.Put(count);
  return bytes;
}

std::optional<Request> DecodeRequest(std::span<const std::byte> bytes) noexcept {
  BigEndianReader reader(bytes);
  const auto header = reader.Get<std::uint16_t>();
  Request request;
  request.command = static_cast<Command>(reader.Get<std::uint16_t>());
  reader.Get(&request.count);
  if (!reader.exactly() || header != kHeader) return {};
  return request;
}

std::optional<Record> DecodeRecord(std::span<const std::byte> bytes) noexcept {
  BigEndianReader reader(bytes);
  Record record;
  reader.Get(&record.sequence);
  reader.Get(&record.sample);
  reader.Get(&record.status);
  for (std::int32_t& count : record.counts) reader.Get(&count);
  if (!reader.exactly()) return {};
  return record;
}

}  // namespace predictor::rdt
