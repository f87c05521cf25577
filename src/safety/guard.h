// The output guard: the last stage before the wire, and the profile of a stop.
#pragma once

#include <array>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// Hard bounds of one arm's joints.
struct JointBounds {
  JointVector lower, upper;      // [rad]
  JointVector velocity;          // [rad/s]
  JointVector acceleration;      // [rad/s²]
};

// Scales both arms' last command down by one common factor, from 1 to 0, so that the handles keep
// their relative pose, with acceleration and jerk of the faster handle within bounds (jerk-limited,
// as short as they allow).
class StopProfile {
 public:
  StopProfile() = default;
  // acceleration [m/s²], jerk [m/s³] at the handles, dt [s].
  StopProfile(double acceleration, double jerk, double dt);
  // Begins from the handles' present speed and acceleration along their motion.
  // speed [m/s]: of the faster handle (rotation counted at 0.2 m); rate [m/s²]: its derivative.
  void Begin(double speed, double rate) noexcept;
  // The factor for the next tick, in [0, 1]; 0 once at rest.
  double Next() noexcept;
  bool done() const;
};

// Clamps a command: finite, inside velocity bounds, within one tick's acceleration of what was last
// sent, and never so fast towards a joint limit that it could not stop before it. Nominal dt.
class Guard {
 public:
  Guard() = default;
  Guard(const std::array<JointBounds, kHands>& bounds, double dt);
  // Bounds `v` given measured q. Returns how many joints were altered (0 in normal running); a
  // non-finite value is replaced by the last sent one scaled towards rest. No heap, no throw.
  int Apply(const std::array<JointVector, kHands>& q, std::array<JointVector, kHands>* v) noexcept;
  const std::array<JointVector, kHands>& last() const { return last_; }
  void Reset() noexcept;  // last sent: rest

 private:
  std::array<JointBounds, kHands> bounds_;
  std::array<JointVector, kHands> last_;
  double dt_ = 0.001;
};

}  // namespace predictor
