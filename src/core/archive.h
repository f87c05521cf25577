// What a part of the emulator holds between ticks, as bytes: saved in a tick, loaded before one.
//
// A class that remembers something lists it once, for both directions:
//   void Archive(StateArchive& a) { a(x_, v_, count_); }
// What follows from the scenario is not listed: the one who loads has made his parts from the same.
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

#include "core/messages.h"
#include "core/types.h"

namespace predictor {

class StateArchive {
 public:
  static StateArchive ToSave(std::span<std::byte> to) { return {to.data(), to.size(), true}; }
  // Only reads `from`.
  static StateArchive ToLoad(std::span<const std::byte> from) {
    return {const_cast<std::byte*>(from.data()), from.size(), false};
  }

  // Of each field in turn. No heap, no throw.
  template <class... T>
  void operator()(T&... fields) noexcept {
    (Field(fields), ...);
  }

  bool saves() const noexcept { return saves_; }
  // False once the bytes did not suffice, or were not of this state: what was loaded is then void.
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
  // What is loaded may have been made up: what others compute with, count, choose or index by is
  // held to bounds.
  void Field(double& x) noexcept {
    Bytes(&x, sizeof x);
    if (!(x == HUGE_VAL)) Bound(x);  // infinite is no limit, or never
  }
  void Bound(double x) noexcept {
    constexpr double kMost = 1e12;  // of any unit; squares and products of some are finite yet
    if (!saves_ && !(std::abs(x) < kMost)) Fail();
  }
  void Field(bool& x) noexcept {
    std::uint8_t byte = x ? 1 : 0;
    Bytes(&byte, sizeof byte);
    if (byte > 1) Fail();
    x = byte == 1;
  }
  void Field(int& x) noexcept {
    constexpr int kMost = 1 << 30;  // room to count on: twelve days of ticks
    Bytes(&x, sizeof x);
    if (!saves_ && (x < -kMost || x > kMost)) Fail();
  }
  void Field(RunState& x) noexcept { Enumeration(&x, kRunStates); }
  void Field(StopCause& x) noexcept { Enumeration(&x, kStopCauses); }
  void Field(Quantity& x) noexcept { Enumeration(&x, kQuantities); }
  template <class E>
  void Enumeration(E* x, int count) noexcept {
    Bytes(x, sizeof *x);
    if (static_cast<int>(*x) >= count) Fail();
  }
  template <class T, int R, int C, int O, int MR, int MC>
  void Field(Eigen::Matrix<T, R, C, O, MR, MC>& x) noexcept {
    if constexpr (R == Eigen::Dynamic || C == Eigen::Dynamic) {
      static_assert(MR != Eigen::Dynamic && MC != Eigen::Dynamic, "would need heap");
      auto rows = static_cast<std::int32_t>(x.rows());
      auto cols = static_cast<std::int32_t>(x.cols());
      Field(rows), Field(cols);
      // Numbers of joints are of the scenario.
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
  // Length and presence are of the scenario.
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
  template <class T>
  requires requires(T& x, StateArchive& a) { x.Archive(a); }
  void Field(T& x) noexcept { x.Archive(*this); }

  void Field(Pose& x) noexcept { (*this)(x.p, x.q); }
  void Field(FrameMotion& x) noexcept { (*this)(x.X_W, x.V_W, x.A_W); }
  void Field(Status& x) noexcept {
    (*this)(x.cause, x.hand, x.value, x.limit, x.quantity, x.power_off);
    if (x.hand < -1 || x.hand >= kHands) Fail();
  }
  void Field(HandInput& x) noexcept { (*this)(x.grip, x.X_WH, x.age); }
  void Field(HandWrench& x) noexcept { (*this)(x.present, x.F_H_W); }
  void Field(ArmSample& x) noexcept {
    (*this)(x.present, x.q, x.v, x.F_S_raw, x.arm_sequence, x.sensor_sequence, x.arm_age,
            x.sensor_age, x.sensor_saturated, x.fault, x.arm_link, x.sensor_link);
  }
  void Field(LinkCounts& x) noexcept { (*this)(x.taken, x.lost, x.refused); }
  void Field(DeviceSample& x) noexcept { Field(x.arms); }
  void Field(RenderResult& x) noexcept {
    (*this)(x.v, x.relative_slack, x.elbow_slack, x.elbow_distance, x.relaxed, x.failed,
            x.iterations, x.at_lower, x.at_upper, x.rows, x.kkt_residual, x.manipulability);
  }
  void Field(WorldState& x) noexcept {
    (*this)(x.time, x.cobot_dof, x.q, x.v, x.torque, x.handle, x.object, x.end_effector, x.coupling,
            x.energy);
  }

  std::byte* bytes_;
  std::size_t size_;
  bool saves_;
  std::size_t used_ = 0;
  bool ok_ = true;
};

}  // namespace predictor
