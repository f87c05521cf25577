// Reads and writes numbers in packets, in the byte order of a protocol.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

namespace predictor {

template <class T>
concept Scalar = std::is_arithmetic_v<T>;

// Reads consecutive numbers. If the packet ends too early, the missing numbers are read as zero,
// and ok() is false from then on. Read a whole packet first, and then check ok() once.
template <std::endian kOrder>
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <Scalar T>
  T Get() noexcept {
    std::array<std::byte, sizeof(T)> raw{};
    if (rest_.size() < sizeof(T)) {
      ok_ = false;
      rest_ = {};
      return T{};
    }
    std::memcpy(raw.data(), rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
    if constexpr (kOrder != std::endian::native) std::reverse(raw.begin(), raw.end());
    if constexpr (std::is_same_v<T, bool>)
      return raw[0] != std::byte{0};
    else
      return std::bit_cast<T>(raw);
  }
  template <Scalar T>
  void Get(T* to) noexcept {
    *to = Get<T>();
  }
  void Skip(std::size_t bytes) noexcept {
    ok_ = ok_ && bytes <= rest_.size();
    rest_ = rest_.subspan(std::min(bytes, rest_.size()));
  }

  std::span<const std::byte> rest() const noexcept { return rest_; }
  bool ok() const noexcept { return ok_; }
  // Returns whether all values were present and no bytes remain.
  bool exactly() const noexcept { return ok_ && rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
};

// Writes consecutive numbers to a buffer. If the buffer is too small, ok() is false.
template <std::endian kOrder>
class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::byte> to) : to_(to) {}

  template <Scalar T>
  void Put(T value) noexcept {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if constexpr (kOrder != std::endian::native) std::reverse(raw.begin(), raw.end());
    Put(std::span<const std::byte>(raw));
  }
  void Put(std::span<const std::byte> bytes) noexcept {
    if (used_ + bytes.size() > to_.size()) {
      ok_ = false;
      return;
    }
    std::copy(bytes.begin(), bytes.end(), to_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ += bytes.size();
  }

  std::span<const std::byte> written() const noexcept { return to_.first(used_); }
  std::size_t size() const noexcept { return used_; }
  bool ok() const noexcept { return ok_; }

 private:
  std::span<std::byte> to_;
  std::size_t used_ = 0;
  bool ok_ = true;
};

using BigEndianReader = ByteReader<std::endian::big>;
using BigEndianWriter = ByteWriter<std::endian::big>;
using LittleEndianReader = ByteReader<std::endian::little>;
using LittleEndianWriter = ByteWriter<std::endian::little>;

}  // namespace predictor
