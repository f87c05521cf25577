// Does a push along an axis of the world read as a push along that axis? A sensor mounted turned,
// mirrored, or at the other arm's socket would drive the arms against the hand.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/types.h"

namespace predictor {

// A direction along an axis of W.
struct AxisReading {
  std::int8_t axis = -1;  // 0 x, 1 y, 2 z; −1: none
  bool negative = false;
  bool other_hand = false;  // it is the other handle's sensor that read it
  bool operator==(const AxisReading&) const = default;
};

// One handle's test: the person pushes along +x, +y and +z of W, one after the other. Fed with the
// hands' wrenches as they are estimated. No heap, no exception.
class PushTest {
 public:
  static constexpr double kLeast = 5, kMost = 25;  // of a push that counts [N]
  static constexpr double kDominant = 3;           // times each of the other components
  static constexpr double kLong = 0.3;             // as long it must last [s]
  static constexpr double kFree = 2;               // less is no push [N]
  static constexpr int kAxes = 3;

  enum class Hint : std::uint8_t { kNone, kPush, kSofter, kStraighter, kLetGo };

  // The wrenches F_H_W of the handle that is to be pushed and of the other (zero: there is none),
  // dt [s] after the last ones.
  void Update(const Wrench& pushed, const Wrench& other, double dt) noexcept;

  // The axis to push along now, its + direction; kAxes once done.
  int axis() const noexcept { return axis_; }
  bool done() const noexcept { return axis_ == kAxes; }
  // All read as they were pushed. Only once done.
  bool passed() const noexcept;
  const std::array<AxisReading, kAxes>& readings() const noexcept { return readings_; }
  Hint hint() const noexcept { return hint_; }  // what the person should do now

  // Not from the tick: that the push along this axis, 0 … 2, read otherwise; "" if it read as
  // pushed, or has not been made yet.
  std::string Wrong(int axis) const;
  // The same: what the readings look like, and what to do; "" if it passed or is not done.
  std::string Refusal() const;

 private:
  void Await(const AxisReading& reading, double dt) noexcept;

  int axis_ = 0;
  std::array<AxisReading, kAxes> readings_;
  AxisReading seen_;   // that lasts now
  double time_ = 0;    // for which it lasts [s]
  bool free_ = false;  // since the last push counted the handle was let go
  Hint hint_ = Hint::kLetGo;
};

// "+x", "−y".
const char* Name(const AxisReading& reading) noexcept;
// What a person is told to do now.
const char* Sentence(PushTest::Hint hint) noexcept;

}  // namespace predictor
