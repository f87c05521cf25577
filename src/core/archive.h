// The emulator keeps a state between ticks. This archive saves that state as bytes after a tick,
// and loads such a state before a tick.
//
// A class with state lists it once, for both directions:
//   void Archive(StateArchive& a) { a(x_, v_, count_); }
// Values that follow from the scenario are not listed, because the emulator that loads the state
// was built from the same scenario.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/members.h"
#include "core/messages.h"
#include "core/types.h"

namespace predictor {

class StateArchive {
 public:
  static StateArchive ToSave(std::span<std::byte> to) { return {to.data(), to.size(), true}; }
  // Returns an archive that only loads, from the bytes in `from`. With a `seed`, every random
  // stream is loaded and then continues with other numbers, which depend on this seed.
  static StateArchive ToLoad(std::span<const std::byte> from,
                             std::optional<std::uint64_t> seed = std::nullopt) {
    StateArchive archive = {const_cast<std::byte*>(from.data()), from.size(), false};
    archive.seed_ = seed;
    return archive;
  }

  // Saves or loads each field in turn. The archive does not use the heap and does not throw.
  template <class... T>
  void operator()(T&... fields) noexcept {
    (Field(fields), ...);
  }

  bool saves() const noexcept { return saves_; }
  // Returns the seed for the random streams, or nothing if they continue as they were saved.
  const std::optional<std::uint64_t>& seed() const noexcept { return seed_; }
  // Returns false if there were too few bytes or if the bytes did not describe this state. The
  // loaded state is then invalid.
  bool ok() const noexcept { return ok_; }
  void Fail() noexcept { ok_ = false; }
  std::size_t used() const noexcept { return used_; }

 private:
  StateArchive(std::byte* bytes, std::size_t size, bool saves)
      : bytes_(bytes), size_(size), saves_(saves) {}

  void Bytes(void* field, std::size_t n) noexcept {
    if (n > size_ - used_) ok_ = false;
    if (!ok_) return;
    if (saves_)
      std::memcpy(bytes_ + used_, field, n);
    else
      std::memcpy(field, bytes_ + used_, n);
    used_ += n;
  }

  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void Field(T& x) noexcept { Bytes(&x, sizeof x); }
  // The bytes may be forged. Therefore, every loaded number that is used for computing, counting or
  // indexing is checked against bounds.
  void Field(double& x) noexcept {
    Bytes(&x, sizeof x);
    if (!(x == HUGE_VAL)) Bound(x);  // infinity means no limit or never
  }
  void Bound(double x) noexcept {
    constexpr double kMax = 1e12;  // in any unit; squares and products of such values are finite
    if (!saves_ && !(std::abs(x) < kMax)) Fail();
  }
  void Field(bool& x) noexcept {
    std::uint8_t byte = x ? 1 : 0;
    Bytes(&byte, sizeof byte);
    if (byte > 1) Fail();
    x = byte == 1;
  }
  void Field(int& x) noexcept {
    constexpr int kMax = 1 << 30;  // 12 days of ticks at 1 kHz; a counter may then still increase
    Bytes(&x, sizeof x);
    if (!saves_ && (x < -kMax || x > kMax)) Fail();
  }
  void Field(RunState& x) noexcept { Enumeration(&x, kRunStates); }
  void Field(StopCause& x) noexcept { Enumeration(&x, kStopCauses); }
  void Field(Quantity& x) noexcept { Enumeration(&x, kQuantities); }
  void Field(ControllerOutcome& x) noexcept { Enumeration(&x, kControllerOutcomes); }
  template <class E>
  void Enumeration(E* x, int count) noexcept {
    Bytes(x, sizeof *x);
    if (static_cast<int>(*x) >= count) Fail();
  }
  template <class T, int R, int C, int O, int MR, int MC>
  void Field(Eigen::Matrix<T, R, C, O, MR, MC>& x) noexcept {
    if constexpr (R == Eigen::Dynamic || C == Eigen::Dynamic) {
      static_assert(MR != Eigen::Dynamic && MC != Eigen::Dynamic, "would allocate memory");
      auto rows = static_cast<std::int32_t>(x.rows());
      auto cols = static_cast<std::int32_t>(x.cols());
      Field(rows), Field(cols);
      // The scenario determines the dimensions, so a state with other dimensions is invalid.
      if (rows != x.rows() || cols != x.cols()) return Fail();
    }
    Bytes(x.data(), sizeof(T) * static_cast<std::size_t>(x.size()));
    if constexpr (std::is_same_v<T, double>)
      for (Eigen::Index i = 0; i < x.size(); ++i) Bound(x.data()[i]);
  }
  void Field(Quaternion& x) noexcept { Field(x.coeffs()); }
  template <class T, std::size_t N>
  void Field(std::array<T, N>& x) noexcept {
    for (T& element : x) Field(element);
  }
  template <class T, std::size_t N>
  void Field(T (&x)[N]) noexcept {
    for (T& element : x) Field(element);
  }
  // The scenario determines the length and whether the value is present.
  template <class T>
  void Field(std::vector<T>& x) noexcept {
    for (T& element : x) Field(element);
  }
  template <class T>
  void Field(std::optional<T>& x) noexcept {
    if (x) Field(*x);
  }
  template <class T, class D>
  void Field(std::unique_ptr<T, D>& x) noexcept {
    if (x) Field(*x);
  }
  // A class lists its own state. A plain struct is archived member by member.
  template <class T>
  requires std::is_class_v<T>
  void Field(T& x) noexcept {
    if constexpr (requires { x.Archive(*this); })
      x.Archive(*this);
    else
      VisitMembers(x, *this);
  }

  void Field(Pose& x) noexcept { (*this)(x.p, x.q); }
  void Field(Status& x) noexcept {
    (*this)(x.cause, x.hand, x.value, x.limit, x.quantity, x.power_off);
    if (x.hand < -1 || x.hand >= kHands) Fail();
  }

  std::byte* bytes_;
  std::size_t size_;
  bool saves_;
  std::size_t used_ = 0;
  bool ok_ = true;
  std::optional<std::uint64_t> seed_;
};

}  // namespace predictor
