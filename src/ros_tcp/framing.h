// Encodes and decodes frames of the ROS-TCP protocol, version 0.7. A frame consists of u32 length,
// destination, u32 length and payload, all little-endian. A destination that begins with "__" marks
// a command whose payload is JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace predictor::ros_tcp {

struct RosFrame {
  std::string destination, payload;
};

std::string Encode(std::string_view destination, std::string_view payload);

// Converts a byte stream into frames. Removes trailing NULs from destinations and from commands'
// payloads, because ROS 2 clients send them. Skips keep-alives, in which destination and payload
// are empty.
class FrameReader {
 public:
  static constexpr std::uint32_t kLongestDestination = 1024;
  static constexpr std::uint32_t kLongestPayload = 64 * 1024;

  void Feed(std::string_view bytes) { buffer_.append(bytes); }
  // Returns the next complete frame. Returns nothing while the frame is incomplete or after the
  // stream has become unrecoverable.
  std::optional<RosFrame> Next();
  // Returns whether a frame had an invalid length, which makes it impossible to parse the rest of
  // the stream.
  bool broken() const { return broken_; }

 private:
  std::optional<RosFrame> Read();
  std::string buffer_;
  bool broken_ = false;
};

}  // namespace predictor::ros_tcp
