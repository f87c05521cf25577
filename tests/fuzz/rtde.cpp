// Parses any stream as a robot's RTDE data. The first byte determines how the stream is cut, and
// the packets must not depend on these cuts. Each packet is also parsed as the answer to a recipe,
// as a text message, and as a state of any recipe.
#include "devices/ur/rtde.h"

#include <algorithm>
#include <cstdlib>

#include "devices/ur/ur_state.h"
#include "fuzz/target.h"

namespace {

void DecodeAsAnything(std::span<const std::byte> payload) {
  predictor::rtde::RecipeAnswer answer;
  (void)predictor::rtde::Decode(payload, &answer);
  predictor::rtde::TextMessage message;
  if (predictor::rtde::Decode(payload, &message))
    (void)(message.text.size() + message.source.size());
  const int recipe = payload.empty() ? 0 : static_cast<int>(payload[0]);
  for (const bool wrench : {false, true})
    for (const bool load : {false, true}) {
      predictor::UrState state;
      (void)predictor::Decode(payload, recipe, {.wrench = wrench, .payload = load}, &state);
    }
}

std::vector<std::vector<std::byte>> Packets(std::span<const std::byte> bytes, std::size_t cut) {
  predictor::rtde::PacketParser parser;
  std::vector<std::vector<std::byte>> packets;
  for (std::size_t at = 0; at < bytes.size() && !parser.broken();) {
    const std::span<std::byte> room = parser.Room();
    const std::size_t n = std::min({cut, room.size(), bytes.size() - at});
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), n, room.begin());
    parser.Filled(n);
    at += n;
    for (predictor::rtde::Packet packet; parser.Next(&packet);) {
      DecodeAsAnything(packet.payload);
      packets.emplace_back(packet.payload.begin(), packet.payload.end());
    }
  }
  return packets;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  if (Packets(bytes, 1 + data[0]) != Packets(bytes, 1)) std::abort();
  return 0;
}
