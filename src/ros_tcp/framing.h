// Frames of the ROS-TCP protocol, version 0.7: u32 length, destination, u32 length, payload, all
// little-endian. A destination that begins with "__" is a command with JSON as its payload.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace predictor {

struct RosFrame {
  std::string destination, payload;
};

std::string Encode(std::string_view destination, std::string_view payload);

// Takes bytes as they come and gives frames. Trailing NULs of destinations and of commands'
// payloads (ROS 2 clients send them) are cut off; keep-alives (both empty) are passed over.
class FrameReader {
 public:
  static constexpr std::uint32_t kLongestDestination = 1024;
  static constexpr std::uint32_t kLongestPayload = 64 * 1024;

  void Feed(std::string_view bytes) { buffer_.append(bytes); }
  // The next whole frame; nothing while it is incomplete, or once the stream is beyond repair.
  std::optional<RosFrame> Next();
  // A length was announced that no frame may have: the stream cannot be understood any more.
  bool broken() const { return broken_; }

 private:
  std::optional<RosFrame> Read();
  std::string buffer_;
  bool broken_ = false;
};

}  // namespace predictor
