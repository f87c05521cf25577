// Serialises ROS messages in the format of ROS 1 or ROS 2.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace predictor::ros_tcp {

enum class RosDialect {
  kRos1,  // packed, little-endian
  kRos2,  // CDR, little-endian: each number is aligned to its size
};

// Returns "ROS1" or "ROS2".
const char* Name(RosDialect dialect);

class RosWriter {
 public:
  explicit RosWriter(RosDialect dialect) : dialect_(dialect) {
    if (dialect == RosDialect::kRos2) bytes_.assign("\x00\x01\x00\x00", 4);
  }

  RosDialect dialect() const { return dialect_; }
  template <class T>
  void Number(T value) {
    Align(sizeof(T));
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));  // x86-64 and both formats are little-endian
    bytes_.append(raw, sizeof(T));
  }
  void Bool(bool value) { Number<std::uint8_t>(value ? 1 : 0); }
  // Writes the length, then the bytes. ROS 2 counts and writes a terminating NUL.
  void String(std::string_view text) {
    const bool terminated = dialect_ == RosDialect::kRos2;
    Number(static_cast<std::uint32_t>(text.size() + (terminated ? 1 : 0)));
    bytes_.append(text);
    if (terminated) bytes_.push_back('\0');
  }
  // Writes the number of elements that follow.
  void Count(std::size_t n) { Number(static_cast<std::uint32_t>(n)); }

  std::string Take() { return std::move(bytes_); }

 private:
  // Aligns a value relative to the first byte after the header.
  void Align(std::size_t size) {
    if (dialect_ == RosDialect::kRos2)
      bytes_.append((size - (bytes_.size() - 4) % size) % size, '\0');
  }

  RosDialect dialect_;
  std::string bytes_;
};

}  // namespace predictor::ros_tcp
