// Tests whether a push along an axis of the world is read as a push along that axis. If a sensor is
// rotated, mirrored, or connected to the other arm's socket, the arms would move against the hand.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/types.h"

namespace predictor::commissioning {

// A direction along an axis of W.
struct AxisReading {
  std::int8_t axis = -1;  // 0 x, 1 y, 2 z; −1: no clear axis
  bool negative = false;
  bool other_hand = false;  // the sensor of the other handle measured the push
  bool operator==(const AxisReading&) const = default;
};

// The test of one handle. The person pushes along +x, +y and +z of W, one after the other. The test
// receives the estimated wrenches of the hands. The function does not use the heap and does not
// throw.
class PushTest {
 public:
  static constexpr double kMinForce = 5,
                          kMaxForce = 25;  // smallest and largest force of a push that counts [N]
  static constexpr double kDominant = 3;   // smallest ratio to each of the other components
  static constexpr double kLong = 0.3;     // minimum duration [s]
  static constexpr double kFree = 2;       // a smaller force is not a push [N]
  static constexpr int kAxes = 3;

  enum class Hint : std::uint8_t { kNone, kPush, kSofter, kStraighter, kLetGo };

  // `pushed` is the wrench F_H_W of the pushed handle. `other` is the wrench of the other handle,
  // or zero if there is no other handle. `dt` is the time since the last call [s].
  void Update(const Wrench& pushed, const Wrench& other, double dt) noexcept;

  // Returns the axis along which the person must push now, in its positive direction, or kAxes when
  // the test is done.
  int axis() const noexcept { return axis_; }
  bool done() const noexcept { return axis_ == kAxes; }
  // Returns whether every push was read correctly. The result is valid only when the test is done.
  bool passed() const noexcept;
  const std::array<AxisReading, kAxes>& readings() const noexcept { return readings_; }
  Hint hint() const noexcept { return hint_; }  // the person's next action

  // Describes how the push along this axis (0 to 2) was read incorrectly. Returns "" if the push
  // was read correctly or has not been made yet. Do not call this function in a tick.
  std::string Wrong(int axis) const;
  // Returns the pattern of the readings and the remedy, or "" if the test passed or is not done. Do
  // not call this function in a tick.
  std::string Refusal() const;

 private:
  void Await(const AxisReading& reading, double dt) noexcept;

  int axis_ = 0;
  std::array<AxisReading, kAxes> readings_;
  AxisReading seen_;   // the current reading
  double time_ = 0;    // duration of the current reading [s]
  bool free_ = false;  // the handle was released after the last push that counted
  Hint hint_ = Hint::kLetGo;
};

// Returns the name of an axis, such as "+x" or "−y".
const char* Name(const AxisReading& reading) noexcept;
// Returns the current instruction to the person.
const char* Sentence(PushTest::Hint hint) noexcept;

}  // namespace predictor::commissioning
