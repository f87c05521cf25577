// Common Data Representation as ROS 2 writes it (little-endian, each value at a multiple of its
// size), driven by the walks of fields.h.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "recording/fields.h"

namespace predictor::recording {

static_assert(std::endian::native == std::endian::little);
inline constexpr std::size_t kCdrHead = 4;  // that it is little-endian
// No message of a tick is longer: each value costs at most its alignment more than its size.
inline constexpr std::size_t kLongestTickMessage = 2 * sizeof(TickRecord) + 64;

// Writes where there is room for kLongestTickMessage.
class CdrWriter {
 public:
  explicit CdrWriter(std::byte* to) : start_(to + kCdrHead), at_(to + kCdrHead) {
    constexpr std::array<std::uint8_t, kCdrHead> kHead = {0, 1, 0, 0};
    std::memcpy(to, kHead.data(), kCdrHead);
  }
  std::size_t size() const { return static_cast<std::size_t>(at_ - start_) + kCdrHead; }

  template <class T>
  requires std::is_arithmetic_v<T>
  void Value(const char*, const T& x, const char* = "") {
    Align(sizeof(T));
    std::memcpy(at_, &x, sizeof(T));
    at_ += sizeof(T);
  }
  template <class E>
  void Enum(const char* name, const E& x) {
    Value(name, static_cast<std::uint8_t>(x));
  }
  template <class E>
  void Loose(const char* name, const E& x) {
    Value(name, static_cast<std::uint8_t>(x));
  }
  template <class T, std::size_t N>
  void Values(const char*, const std::array<T, N>& x, const char* = "") {
    Align(sizeof(T));
    std::memcpy(at_, x.data(), sizeof x);
    at_ += sizeof x;
  }
  // As many as there are joints; more if what should be zero behind them is not.
  template <std::size_t N>
  void Joints(const char* name, const std::array<double, N>& x, std::size_t dof, const char*) {
    std::size_t n = N;
    while (n > dof && std::bit_cast<std::uint64_t>(x[n - 1]) == 0) --n;
    Value(name, static_cast<std::uint32_t>(n));
    for (std::size_t j = 0; j < n; ++j) Value(name, x[j]);
  }
  void Pose(const char* name, const PoseRecord& x) {
    Values(name, x.p);
    for (const std::size_t k : {1U, 2U, 3U, 0U}) Value(name, x.q[k]);
  }
  void Twist(const char* name, const std::array<double, 6>& x, const char* = "") {
    Values(name, x);
  }
  void Wrench(const char* name, const std::array<double, 6>& x, const char* = "") {
    Values(name, x);
  }
  void Reserved(const auto&) {}
  void Message(const char*, const char*, auto&& visit) { visit(*this); }
  // As many as were taken; more if one behind them is not as it begins.
  void Inputs(const char* name, const char*, const auto& list, std::size_t count, auto&& visit) {
    const RunInput none;
    std::size_t n = list.size();
    while (n > count && SameBits(list[n - 1], none)) --n;
    Value(name, static_cast<std::uint32_t>(n));
    for (std::size_t i = 0; i < n; ++i) visit(*this, list[i]);
  }

 private:
  void Align(std::size_t size) {
    while ((at_ - start_) % static_cast<std::ptrdiff_t>(size) != 0) *at_++ = std::byte{0};
  }

  std::byte *start_, *at_;
};

// Reads what a stranger may have written: ok() is false from the first value on that is not there
// or cannot be.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::byte> from) {
    constexpr std::array<std::uint8_t, 2> kHead = {0, 1};
    ok_ = from.size() >= kCdrHead && std::memcmp(from.data(), kHead.data(), 2) == 0;
    if (ok_) rest_ = from.subspan(kCdrHead);
  }
  bool ok() const { return ok_; }
  bool Done() const { return ok_ && used_ == rest_.size(); }
  std::size_t used() const { return used_ + kCdrHead; }

  template <class T>
  requires std::is_arithmetic_v<T>
  void Value(const char*, T& x, const char* = "") {
    used_ = (used_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (used_ > rest_.size() || rest_.size() - used_ < sizeof(T)) ok_ = false;
    if (!ok_) return;
    std::memcpy(&x, rest_.data() + used_, sizeof(T));
    used_ += sizeof(T);
  }
  void Enum(const char* name, RunState& x) { Bounded(name, &x, kRunStates); }
  void Enum(const char* name, StopCause& x) { Bounded(name, &x, kStopCauses); }
  void Enum(const char* name, Quantity& x) { Bounded(name, &x, kQuantities); }
  // Whoever uses it checks it.
  template <class E>
  void Loose(const char* name, E& x) {
    Bounded(name, &x, 256);
  }
  template <class T, std::size_t N>
  void Values(const char* name, std::array<T, N>& x, const char* = "") {
    for (T& value : x) Value(name, value);
  }
  template <std::size_t N>
  void Joints(const char* name, std::array<double, N>& x, std::size_t dof, const char*) {
    const std::size_t n = Length(name, N);
    if (dof > N) ok_ = false;
    for (std::size_t j = 0; j < n; ++j) Value(name, x[j]);
  }
  void Pose(const char* name, PoseRecord& x) {
    Values(name, x.p);
    for (const std::size_t k : {1U, 2U, 3U, 0U}) Value(name, x.q[k]);
  }
  void Twist(const char* name, std::array<double, 6>& x, const char* = "") { Values(name, x); }
  void Wrench(const char* name, std::array<double, 6>& x, const char* = "") { Values(name, x); }
  void Reserved(const auto&) {}
  void Message(const char*, const char*, auto&& visit) { visit(*this); }
  void Inputs(const char* name, const char*, auto& list, std::size_t count, auto&& visit) {
    const std::size_t n = Length(name, list.size());
    if (count > list.size()) ok_ = false;
    for (std::size_t i = 0; i < n; ++i) visit(*this, list[i]);
  }

 private:
  template <class E>
  void Bounded(const char* name, E* x, int count) {
    std::uint8_t value = 0;
    Value(name, value);
    if (value >= count) ok_ = false;
    if (ok_) *x = static_cast<E>(value);
  }
  std::size_t Length(const char* name, std::size_t most) {
    std::uint32_t n = 0;
    Value(name, n);
    if (n > most) ok_ = false;
    return ok_ ? n : 0;
  }

  std::span<const std::byte> rest_;
  std::size_t used_ = 0;
  bool ok_ = false;
};

}  // namespace predictor::recording
