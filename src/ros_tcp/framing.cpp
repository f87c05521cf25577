#include "ros_tcp/framing.h"

#include <cstring>

namespace predictor::ros_tcp {
namespace {

void AppendPart(std::string_view part, std::string* out) {
  const auto length = static_cast<std::uint32_t>(part.size());
  char raw[4];
  std::memcpy(raw, &length, 4);
  out->append(raw, 4);
  out->append(part);
}

std::uint32_t LengthAt(const std::string& bytes, std::size_t at) {
  std::uint32_t length;
  std::memcpy(&length, bytes.data() + at, 4);
  return length;
}

void CutNuls(std::string* text) {
  while (!text->empty() && text->back() == '\0') text->pop_back();
}

}  // namespace

std::string Encode(std::string_view destination, std::string_view payload) {
  std::string frame;
  frame.reserve(8 + destination.size() + payload.size());
  AppendPart(destination, &frame);
  AppendPart(payload, &frame);
  return frame;
}

std::optional<RosFrame> FrameReader::Next() {
  while (std::optional<RosFrame> frame = Read()) {
    if (frame->destination.empty() && frame->payload.empty()) continue;  // keep-alive
    return frame;
  }
  return std::nullopt;
}

std::optional<RosFrame> FrameReader::Read() {
  if (broken_ || buffer_.size() < 4) return std::nullopt;
  const std::uint32_t n = LengthAt(buffer_, 0);
  broken_ = n > kLongestDestination;
  if (broken_ || buffer_.size() < 8 + std::size_t{n}) return std::nullopt;
  const std::uint32_t m = LengthAt(buffer_, 4 + std::size_t{n});
  broken_ = m > kLongestPayload;
  const std::size_t whole = 8 + std::size_t{n} + m;
  if (broken_ || buffer_.size() < whole) return std::nullopt;
  RosFrame frame{buffer_.substr(4, n), buffer_.substr(8 + std::size_t{n}, m)};
  buffer_.erase(0, whole);
  CutNuls(&frame.destination);
  if (frame.destination.rfind("__", 0) == 0) CutNuls(&frame.payload);
  return frame;
}

}  // namespace predictor::ros_tcp
