// The output guard: the last stage before the wire.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// Hard bounds of one arm's joints; all empty for an absent arm.
struct JointBounds {
  JointVector lower, upper;  // [rad]
  JointVector velocity;      // [rad/s], > 0
  JointVector acceleration;  // [rad/s²], > 0
};

// Largest speed [rad/s] towards a limit at `distance` [rad] from which a joint commanded every dt
// [s] stops before it with `acceleration` [rad/s²], when it answers `reaction` [s] late: then it
// still moves by what was sent before, which is faster by acceleration · reaction at most. 0
// beyond.
double BrakingSpeed(double distance, double acceleration, double reaction, double dt) noexcept;

// Reaction time [s] of a joint's velocity loop: the root mean square of its impulse response's
// delay, so that a joint braked at a constant rate coasts as far as one with this pure delay. One
// whose loop is damped by less than 0.8 may still swing past its limit by up to 1 mrad.
double ReactionTime(const VelocityLoopSpec& loop) noexcept;

// Clamps a command: finite, inside velocity bounds, within one tick's acceleration of what was last
// sent, and never so fast towards a joint limit that it could not stop before it; beyond a limit
// only motion back is let through. Where these conflict, acceleration yields. Reckons with the
// nominal tick, so that a late or early tick cannot widen what may be sent, but for braking after
// missed ones; a tick that may come late by x needs a reaction time of x.
class Guard {
 public:
  Guard() = default;
  // dt: nominal tick [s]. reaction: between measuring a position, sending a velocity for it and the
  // joint having that [s], of the slower arm (ReactionTime, and what else comes between).
  Guard(const std::array<JointBounds, kHands>& bounds, double dt, double reaction = 0);
  // Bounds `v` given measured q, each one number a joint. Returns how many joints were altered (0
  // in normal running). If any number is not finite or missing, nothing in the command is trusted:
  // both arms brake along the last one sent by one common factor. ticks: since then, so many times
  // a tick's acceleration may bring a joint nearer to rest. No heap, no throw.
  int Apply(const std::array<JointVector, kHands>& q, std::array<JointVector, kHands>* v,
            int ticks = 1) noexcept;
  // Brings `v` to `factor` · v: both arms go there from what was sent last by one share of the way,
  // all of it where no joint must speed up or brake by more than its acceleration for that. Handles
  // that are slow enough at either end are so on the way. Returns how many joints were altered;
  // none where a number is missing. To be called before Apply. No heap, no throw.
  int Slow(double factor, std::array<JointVector, kHands>* v) const noexcept;
  const std::array<JointVector, kHands>& last() const noexcept { return last_; }
  // What was sent last is so slow that the next command may be rest.
  bool MayRestNext() const noexcept;
  void Reset() noexcept;  // last sent: rest
  void Archive(StateArchive& a) noexcept { a(last_); }

 private:
  bool Trusted(const std::array<JointVector, kHands>& q,
               const std::array<JointVector, kHands>& v) const noexcept;
  double BrakingFactor() const noexcept;
  double Bound(int arm, int joint, double q, double v, int ticks) const noexcept;

  std::array<JointBounds, kHands> bounds_;
  std::array<JointVector, kHands> last_;
  double dt_ = 0.001;
  double reaction_ = 0;
};

}  // namespace predictor
