// The output guard bounds every command before it is sent.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// The hard bounds of one arm's joints. All vectors are empty for an absent arm.
struct JointBounds {
  JointVector lower, upper;  // [rad]
  JointVector velocity;      // [rad/s], > 0
  JointVector acceleration;  // [rad/s²], > 0
};

// Returns the largest speed [rad/s] from which a joint can stop before a limit at `distance` [rad].
// The joint is commanded every dt [s], brakes with `acceleration` [rad/s²] and has a reaction time
// of `reaction` [s]. Until the joint reacts, it follows earlier commands. The speed of these
// commands is higher by at most acceleration · reaction. If the joint is beyond the limit, the
// result is 0.
double BrakingSpeed(double distance, double acceleration, double reaction, double dt) noexcept;

// Returns the reaction time [s] of a joint's velocity loop. The reaction time is the root mean
// square delay of the loop's impulse response. A joint that brakes at a constant rate overruns by
// the same distance as a joint with this pure delay. With a damping ratio below 0.8, the joint may
// still overshoot its limit by up to 1 mrad.
double ReactionTime(const VelocityLoopSpec& loop) noexcept;

// Clamps a command to four conditions. The command is finite and within the velocity bounds, it
// differs from the last command by at most one tick's acceleration, and it always allows each joint
// to stop before its limit. If a joint is beyond a limit, only motion back towards the permitted
// range is allowed. If these conditions conflict, the guard exceeds the acceleration bound. The
// guard computes with the nominal tick, so that a late or early tick cannot widen the bounds. Only
// braking after missed ticks may use more acceleration than that of one nominal tick. If a tick may
// be late by x, the caller must increase the reaction time by x.
class Guard {
 public:
  Guard() = default;
  // `dt` is the nominal tick [s]. `reaction` is the time from measuring a position until the joint
  // reaches the resulting velocity [s], for the slower arm (ReactionTime plus other delays).
  Guard(const std::array<JointBounds, kHands>& bounds, double dt, double reaction = 0);
  // Bounds the command `v` at the measured joint positions q. `v` and q have one number per joint.
  // Returns the number of altered joints (0 in normal operation). If any number is missing or not
  // finite, the whole command is discarded. Both arms then brake in the direction of the last
  // command, which is scaled by one common factor. `ticks` is the number of ticks since the last
  // command. The braking may use the acceleration of all these ticks. Does not use the heap or
  // throw.
  int Apply(const std::array<JointVector, kHands>& q, std::array<JointVector, kHands>* v,
            int ticks = 1) noexcept;
  // Scales `v` by `factor` and the last command by `last_factor`. `last_factor` is 1 unless the
  // last command became too fast because the arms' posture has changed. The commands of both arms
  // change by the same share of the difference between the scaled last command and the scaled `v`.
  // This share of the change is 1 unless a joint would exceed its acceleration bound. If the
  // handles are below their speed cap with the scaled last command and with the scaled `v`, they
  // are also below it with every command between these two. The acceleration bound has priority
  // over `last_factor`. Returns the number of altered joints, or 0 if a number is missing. Call
  // this before Apply. Does not use the heap or throw.
  int Slow(double factor, std::array<JointVector, kHands>* v,
           double last_factor = 1) const noexcept;
  const std::array<JointVector, kHands>& last() const noexcept { return last_; }
  // Returns whether the last command is so slow that the next command may be zero.
  bool MayRestNext() const noexcept;
  void Reset() noexcept;  // the last command then counts as zero
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
