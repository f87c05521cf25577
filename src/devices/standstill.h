// The time for which an arm continues to move after the last command if this program has been
// killed or hangs. The pages docs/robots/connect-a-*.md state these times. Tests that kill the
// program check that the fake controllers stop within these times.
#pragma once

#include "scenario/machine.h"

namespace predictor {

struct Standstill {
  double silence;       // time without commands after which the robot brakes [s]
  double deceleration;  // deceleration of its fastest joint while braking [rad/s²]
  double settling;      // time until the joints have followed their own controller to rest [s]
  // Returns the longest time until the arm is at rest if its fastest joint moves at `speed`
  // [rad/s].
  constexpr double Within(double speed) const { return silence + speed / deceleration + settling; }
};

// For a UR, these times follow from the watchdog in our program on the controller (ur_script.h) and
// from its stopj command.
inline constexpr Standstill kUrStandstill{0.020, 10, 0.060};
// A Franka arm first misses 20 commands of one millisecond each, and meanwhile continues with its
// last acceleration. The arm then brakes by itself. The manufacturer publishes no deceleration, so
// this value is an assumption.
inline constexpr Standstill kFrankaStandstill{0.020, 7, 0.060};

constexpr const Standstill& StandstillOf(ArmMake make) {
  return make == ArmMake::kUr ? kUrStandstill : kFrankaStandstill;
}

}  // namespace predictor
