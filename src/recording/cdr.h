// Reads and writes the Common Data Representation as ROS 2 uses it (little-endian, with each value
// aligned to its size), based on core/tick_fields.h.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "core/tick_fields.h"

namespace predictor::recording {

static_assert(std::endian::native == std::endian::little);
inline constexpr std::size_t kCdrHead = 4;  // marks little-endian data
// The upper bound of the size of a tick's messages. Each value needs at most its size plus the
// padding for its alignment.
inline constexpr std::size_t kLongestTickMessage = 2 * sizeof(TickRecord) + 64;

// Compares the bits of two records, so −0 differs from 0, and a NaN equals itself.
template <class T>
bool SameBits(const T& a, const T& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  const void *at = &a, *bt = &b;
  return std::memcmp(at, bt, sizeof(T)) == 0;
}

// Writes to a buffer with space for kLongestTickMessage.
class CdrWriter {
 public:
  explicit CdrWriter(std::byte* to) : start_(to + kCdrHead), at_(to + kCdrHead) {
    constexpr std::array<std::uint8_t, kCdrHead> kHead = {0, 1, 0, 0};
    std::memcpy(to, kHead.data(), kCdrHead);
  }
  std::size_t size() const { return static_cast<std::size_t>(at_ - start_) + kCdrHead; }

  template <class T>
  void Put(const T& x) {
    while ((at_ - start_) % static_cast<std::ptrdiff_t>(sizeof(T)) != 0) *at_++ = std::byte{0};
    std::memcpy(at_, &x, sizeof(T));
    at_ += sizeof(T);
  }

  template <class T>
  void Value(const TickField&, const T& x) {
    if constexpr (std::is_enum_v<T>)
      Put(static_cast<std::uint8_t>(x));
    else
      Put(x);
  }
  void Flag(const TickField&, std::uint8_t x) { Put(x); }
  void Presence(const TickField&, std::uint8_t x) { Put(x); }
  void Unchecked(const TickField& f, const auto& x) { Value(f, x); }
  void Values(const TickField&, const auto& x) {
    for (const auto& value : x) Put(value);
  }
  void Named(const TickField& f, const auto&, const auto& x) { Values(f, x); }
  // Writes one value for each joint, or more values if later ones are not zero.
  template <std::size_t N>
  void Joints(const TickField&, const std::array<double, N>& x, std::uint8_t dof) {
    std::size_t n = N;
    while (n > dof && std::bit_cast<std::uint64_t>(x[n - 1]) == 0) --n;
    Put(static_cast<std::uint32_t>(n));
    for (std::size_t j = 0; j < n; ++j) Put(x[j]);
  }
  void Pose(const TickField& f, const PoseRecord& x) {
    Values(f, x.p);
    for (const std::size_t k : {1U, 2U, 3U, 0U}) Put(x.q[k]);
  }
  // Writes the poses that are present, or more poses if later ones are not zero.
  template <std::size_t N>
  void Poses(const TickField& f, const std::array<PoseRecord, N>& x, std::uint8_t count) {
    const PoseRecord none{};
    std::size_t n = N;
    while (n > count && SameBits(x[n - 1], none)) --n;
    Put(static_cast<std::uint32_t>(n));
    for (std::size_t i = 0; i < n; ++i) Pose(f, x[i]);
  }
  void Twist(const TickField& f, const std::array<double, 6>& x) { Values(f, x); }
  void Wrench(const TickField& f, const std::array<double, 6>& x) { Values(f, x); }
  void Reserved(const auto&) {}
  void Message(const TickField&, const char*, auto&& visit) { visit(*this); }
  // Writes the inputs that were used, or more inputs if a later one is not in its initial state.
  void Inputs(const TickField&, const char*, const auto& list, std::uint8_t count, auto&& visit) {
    const RunInput none;
    std::size_t n = list.size();
    while (n > count && SameBits(list[n - 1], none)) --n;
    Put(static_cast<std::uint32_t>(n));
    for (std::size_t i = 0; i < n; ++i) visit(*this, list[i]);
  }

 private:
  std::byte *start_, *at_;
};

// Reads untrusted bytes. The function ok() returns false from the first value that is missing or
// impossible.
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
  void Get(T& x) {
    used_ = (used_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (used_ > rest_.size() || rest_.size() - used_ < sizeof(T)) ok_ = false;
    if (!ok_) return;
    std::memcpy(&x, rest_.data() + used_, sizeof(T));
    used_ += sizeof(T);
  }

  template <class T>
  requires std::is_arithmetic_v<T>
  void Value(const TickField&, T& x) { Get(x); }
  void Value(const TickField&, RunState& x) { Bounded(&x, kRunStates); }
  void Value(const TickField&, StopCause& x) { Bounded(&x, kStopCauses); }
  void Value(const TickField&, Quantity& x) { Bounded(&x, kQuantities); }
  void Flag(const TickField&, std::uint8_t& x) { Get(x); }
  void Presence(const TickField&, std::uint8_t& x) { Get(x); }
  // The code that uses this value must check it.
  void Unchecked(const TickField&, auto& x) { Bounded(&x, 256); }
  void Values(const TickField&, auto& x) {
    for (auto& value : x) Get(value);
  }
  void Named(const TickField& f, const auto&, auto& x) { Values(f, x); }
  template <std::size_t N>
  void Joints(const TickField&, std::array<double, N>& x, std::uint8_t dof) {
    const std::size_t n = Length(N);
    if (dof > N) ok_ = false;
    for (std::size_t j = 0; j < n; ++j) Get(x[j]);
  }
  void Pose(const TickField& f, PoseRecord& x) {
    Values(f, x.p);
    for (const std::size_t k : {1U, 2U, 3U, 0U}) Get(x.q[k]);
  }
  template <std::size_t N>
  void Poses(const TickField& f, std::array<PoseRecord, N>& x, std::uint8_t count) {
    const std::size_t n = Length(N);
    if (count > N) ok_ = false;
    for (std::size_t i = 0; i < n; ++i) Pose(f, x[i]);
  }
  void Twist(const TickField& f, std::array<double, 6>& x) { Values(f, x); }
  void Wrench(const TickField& f, std::array<double, 6>& x) { Values(f, x); }
  void Reserved(const auto&) {}
  void Message(const TickField&, const char*, auto&& visit) { visit(*this); }
  void Inputs(const TickField&, const char*, auto& list, std::uint8_t count, auto&& visit) {
    const std::size_t n = Length(list.size());
    if (count > list.size()) ok_ = false;
    for (std::size_t i = 0; i < n; ++i) visit(*this, list[i]);
  }

 private:
  template <class E>
  void Bounded(E* x, int count) {
    std::uint8_t value = 0;
    Get(value);
    if (value >= count) ok_ = false;
    if (ok_) *x = static_cast<E>(value);
  }
  std::size_t Length(std::size_t max) {
    std::uint32_t n = 0;
    Get(n);
    if (n > max) ok_ = false;
    return ok_ ? n : 0;
  }

  std::span<const std::byte> rest_;
  std::size_t used_ = 0;
  bool ok_ = false;
};

}  // namespace predictor::recording
