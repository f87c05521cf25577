// Parses any stream as data from Unity.
#include "fuzz/target.h"
#include "ros_tcp/framing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  predictor::ros_tcp::FrameReader reader;
  for (std::size_t at = 0; at < text.size() && !reader.broken(); at += 1U + data[0]) {
    reader.Feed(text.substr(at, 1U + data[0]));
    while (reader.Next()) {
    }
  }
  return 0;
}
