// Packets of Universal Robots' Real-Time Data Exchange (RTDE), version 2 (TCP 30004, big-endian).
// Source: https://www.universal-robots.com, "Real-Time Data Exchange (RTDE) guide". A packet
// consists of its size including the header (two bytes), its type (one byte) and its payload.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/wire/bytes.h"

namespace predictor::rtde {

inline constexpr std::uint16_t kProtocolVersion = 2;
inline constexpr std::size_t kHeaderSize = 3;
inline constexpr std::size_t kMaxPacket = 4096;  // larger ones are refused

enum class PacketType : std::uint8_t {
  kVersion = 'V',
  kControllerVersion = 'v',
  kText = 'M',
  kData = 'U',
  kOutputs = 'O',
  kInputs = 'I',
  kStart = 'S',
  kPause = 'P',
};

struct Packet {
  PacketType type = PacketType::kText;
  std::span<const std::byte> payload;  // valid until the parser receives more bytes
};

// Splits a stream into packets. The bytes may arrive in pieces of any size. An invalid size or type
// is a permanent error, because the next packet cannot be found. Does not use the heap.
//
//   parser.Filled(stream.Read(parser.Room()));
//   while (parser.Next(&packet)) ...;
class PacketParser {
 public:
  // Returns the buffer space for the next bytes, which is never empty after Next has returned
  // false.
  std::span<std::byte> Room() noexcept;
  void Filled(std::size_t bytes) noexcept { end_ += bytes; }
  bool Next(Packet* packet) noexcept;
  bool broken() const noexcept { return broken_; }

 private:
  std::array<std::byte, 2 * kMaxPacket> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
  bool broken_ = false;
};

// Writes one packet without using the heap.
class PacketWriter {
 public:
  explicit PacketWriter(PacketType type) noexcept : writer_(buffer_) {
    writer_.Put(std::uint16_t{0});
    writer_.Put(static_cast<std::uint8_t>(type));
  }
  PacketWriter(const PacketWriter&) = delete;
  PacketWriter& operator=(const PacketWriter&) = delete;

  template <Scalar T>
  PacketWriter& Put(T value) noexcept {
    writer_.Put(value);
    return *this;
  }
  PacketWriter& Put(std::string_view text) noexcept {
    writer_.Put(std::as_bytes(std::span(text)));
    return *this;
  }
  // Returns the complete packet including its size, or no bytes if the content was too large.
  std::span<const std::byte> Finish() noexcept;

 private:
  std::array<std::byte, kMaxPacket> buffer_{};
  BigEndianWriter writer_;
};

// An exchanged value. `type` is the name of a type in the guide: DOUBLE, VECTOR6D, INT32, ...
struct Field {
  std::string name;
  std::string_view type;
};

// Returns the size of a value of this type in bytes, or 0 for an unknown type.
std::size_t SizeOf(std::string_view type) noexcept;
// Returns the total size of the recipe's values in bytes.
std::size_t SizeOf(std::span<const Field> recipe) noexcept;
// Returns "a,b,c".
std::string Names(std::span<const Field> recipe);

// Requests of a client. An answer has the same type as its request.
std::vector<std::byte> AskVersion(std::uint16_t version = kProtocolVersion);
std::vector<std::byte> AskControllerVersion();
std::vector<std::byte> AskOutputs(double rate, std::span<const Field> recipe);  // rate [Hz]
std::vector<std::byte> AskInputs(std::span<const Field> recipe);
std::vector<std::byte> AskStart();
std::vector<std::byte> AskPause();

// The payload of the controller's answer to AskOutputs or AskInputs.
struct RecipeAnswer {
  int id = 0;         // ID with which data packets begin; 0: refused
  std::string types;  // "DOUBLE,VECTOR6D,..."
};
bool Decode(std::span<const std::byte> payload, RecipeAnswer* answer);

// Checks the types with which the controller answered a recipe. Returns "" if there is no error.
// Otherwise, returns the rest of a sentence that begins with the controller's address.
std::string Refusal(std::span<const Field> recipe, const RecipeAnswer& answer);

struct TextMessage {
  std::string_view text, source;
  std::uint8_t level = 0;  // 0 exception, 1 error, 2 warning, 3 information
};
bool Decode(std::span<const std::byte> payload, TextMessage* message) noexcept;

}  // namespace predictor::rtde
