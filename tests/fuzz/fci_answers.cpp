// Parses any stream as the answers of a Franka controller. The first byte determines how the stream
// is cut, and the answers must not depend on these cuts.
#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "devices/franka/fci.h"
#include "fuzz/target.h"

namespace {

using Seen = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint8_t>;

std::vector<Seen> Answers(std::span<const std::byte> bytes, std::size_t cut) {
  predictor::fci::AnswerReader reader;
  std::vector<Seen> seen;
  for (std::size_t at = 0; at < bytes.size() && !reader.broken();) {
    const std::span<std::byte> room = reader.room();
    if (room.empty()) std::abort();  // no more data could ever arrive
    const std::size_t n = std::min({cut, room.size(), bytes.size() - at});
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), n, room.begin());
    reader.Arrived(n);
    at += n;
    for (predictor::fci::Answer answer; reader.Next(&answer);) {
      const predictor::fci::Header& h = answer.header;
      seen.emplace_back(static_cast<std::uint32_t>(h.command), h.id, h.size, answer.status());
    }
  }
  return seen;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  if (Answers(bytes, 1 + data[0]) != Answers(bytes, 1)) std::abort();
  return 0;
}
