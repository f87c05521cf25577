// How long an arm goes on after the last word of this program, which was killed or hangs: what
// docs/connect-a-*.md advertise, and what the tests that kill it hold the fakes to.
#pragma once

#include "scenario/machine.h"

namespace predictor {

struct Standstill {
  double silence;       // that the robot bears before it brakes [s]
  double deceleration;  // of its fastest joint then [rad/s²]
  double settling;      // until the joints have followed their own controller to rest [s]
  // The fastest joint goes at `speed` [rad/s].
  constexpr double Within(double speed) const { return silence + speed / deceleration + settling; }
};

// Our own program on the controller: its watchdog (ur_script.h) and its stopj.
inline constexpr Standstill kUrStandstill{0.020, 10, 0.060};
// 20 lost commands of a millisecond, in which the arm goes on as it was accelerating; then its own
// stop, for which the maker gives no figure: assumed.
inline constexpr Standstill kFrankaStandstill{0.020, 7, 0.060};

constexpr const Standstill& StandstillOf(ArmMake make) {
  return make == ArmMake::kUr ? kUrStandstill : kFrankaStandstill;
}

}  // namespace predictor
