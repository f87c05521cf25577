#include "devices/ur/rtde.h"

#include <algorithm>
#include <cstring>

namespace predictor::rtde {
namespace {

bool Known(std::uint8_t type) noexcept {
  return std::string_view("VvMUOISP").find(static_cast<char>(type)) != std::string_view::npos;
}

std::string_view Text(std::span<const std::byte> bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> ToVector(PacketWriter* writer) {
  const auto bytes = writer->Finish();
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> Ask(PacketType type) {
  PacketWriter writer(type);
  return ToVector(&writer);
}

std::vector<std::string_view> Split(std::string_view list) {
  std::vector<std::string_view> parts;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    parts.push_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return parts;
}

}  // namespace

std::span<std::byte> PacketParser::Room() noexcept {
  // The remaining bytes are not a complete packet.
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  return std::span(buffer_).subspan(end_);
}

bool PacketParser::Next(Packet* packet) noexcept {
  if (broken_ || end_ - begin_ < kHeaderSize) return false;
  BigEndianReader header{std::span<const std::byte>(buffer_).subspan(begin_, kHeaderSize)};
  const std::size_t size = header.Get<std::uint16_t>();
  const auto type = header.Get<std::uint8_t>();
  broken_ = size < kHeaderSize || size > kMaxPacket || !Known(type);
  if (broken_ || end_ - begin_ < size) return false;
  packet->type = static_cast<PacketType>(type);
  packet->payload = std::span(buffer_).subspan(begin_ + kHeaderSize, size - kHeaderSize);
  begin_ += size;
  return true;
}

std::span<const std::byte> PacketWriter::Finish() noexcept {
  if (!writer_.ok()) return {};
  BigEndianWriter(buffer_).Put(static_cast<std::uint16_t>(writer_.size()));
  return writer_.written();
}

std::size_t SizeOf(std::string_view type) noexcept {
  struct Size {
    std::string_view type;
    std::size_t bytes;
  };
  static constexpr std::array<Size, 10> kSizes = {{{"BOOL", 1},
                                                   {"UINT8", 1},
                                                   {"UINT32", 4},
                                                   {"INT32", 4},
                                                   {"UINT64", 8},
                                                   {"DOUBLE", 8},
                                                   {"VECTOR3D", 24},
                                                   {"VECTOR6D", 48},
                                                   {"VECTOR6INT32", 24},
                                                   {"VECTOR6UINT32", 24}}};
  for (const Size& size : kSizes)
    if (size.type == type) return size.bytes;
  return 0;
}

std::size_t SizeOf(std::span<const Field> recipe) noexcept {
  std::size_t sum = 0;
  for (const Field& field : recipe) sum += SizeOf(field.type);
  return sum;
}

std::string Names(std::span<const Field> recipe) {
  std::string names;
  for (const Field& field : recipe) names += (names.empty() ? "" : ",") + field.name;
  return names;
}

std::vector<std::byte> AskVersion(std::uint16_t version) {
  PacketWriter writer(PacketType::kVersion);
  return ToVector(&writer.Put(version));
}
std::vector<std::byte> AskControllerVersion() { return Ask(PacketType::kControllerVersion); }
std::vector<std::byte> AskOutputs(double rate, std::span<const Field> recipe) {
  PacketWriter writer(PacketType::kOutputs);
  return ToVector(&writer.Put(rate).Put(Names(recipe)));
}
std::vector<std::byte> AskInputs(std::span<const Field> recipe) {
  PacketWriter writer(PacketType::kInputs);
  return ToVector(&writer.Put(Names(recipe)));
}
std::vector<std::byte> AskStart() { return Ask(PacketType::kStart); }
std::vector<std::byte> AskPause() { return Ask(PacketType::kPause); }

bool Decode(std::span<const std::byte> payload, RecipeAnswer* answer) {
  BigEndianReader reader(payload);
  answer->id = reader.Get<std::uint8_t>();
  answer->types = Text(reader.rest());
  return reader.ok();
}

std::string Refusal(std::span<const Field> recipe, const RecipeAnswer& answer) {
  const auto types = Split(answer.types);
  for (std::size_t i = 0; i < std::min(types.size(), recipe.size()); ++i) {
    if (types[i] == recipe[i].type) continue;
    if (types[i] == "IN_USE")
      return "reports that " + recipe[i].name +
             " is in use by another program or by a fieldbus adapter (EtherNet/IP, PROFINET, "
             "MODBUS). Stop that program or disable that adapter, or choose the other half of the "
             "registers (first register 0 or 24).";
    if (types[i] == "NOT_FOUND")
      return "does not support " + recipe[i].name +
             ". Update PolyScope. (Registers from 24 on exist since versions 3.9 and 5.3; with "
             "older versions, choose first register 0.)";
    return "reports that " + recipe[i].name + " is of type " + std::string(types[i]) + ", not " +
           std::string(recipe[i].type) +
           ". This driver does not support this version of PolyScope.";
  }
  if (types.size() != recipe.size())
    return "answers " + std::to_string(types.size()) + " types for " +
           std::to_string(recipe.size()) +
           " names. This answer does not conform to the RTDE guide.";
  if (answer.id == 0) return "refuses to exchange " + Names(recipe) + ".";
  return "";
}

bool Decode(std::span<const std::byte> payload, TextMessage* message) noexcept {
  BigEndianReader reader(payload);
  const auto part = [&reader] {
    const std::size_t size = reader.Get<std::uint8_t>();
    const auto rest = reader.rest();
    reader.Skip(size);
    return Text(rest.first(std::min(size, rest.size())));
  };
  message->text = part();
  message->source = part();
  message->level = reader.Get<std::uint8_t>();
  return reader.exactly();
}

}  // namespace predictor::rtde
