// A stop: the profile by which both arms come to rest, and what is reported of it.
#pragma once

#include <array>
#include <limits>

#include "core/archive.h"
#include "core/messages.h"
#include "safety/guard.h"
#include "scenario/scenario.h"

namespace predictor {

// Scales both arms' last command by one common factor down to 0, so that the handles keep their
// relative pose: the speed of the faster handle comes to rest in the shortest time that its bounds
// on acceleration and jerk allow (closed form, sampled every tick).
//
// Motion that is speeding up cannot be turned round at once within the jerk bound: the factor first
// rises above 1, by rate²/(2·jerk·speed). It never rises above kOvershoot, nor the speed above the
// cap: a larger rate is cut at once, since a motion that has barely begun does not tell by its last
// command where it was going.
//
// A factor common to all joints scales the handles' twists alike while the Jacobians stay as they
// are; they change over the stop's few centimetres, which StopController corrects.
class StopProfile {
 public:
  static constexpr double kOvershoot = 1.25;  // largest factor

  StopProfile() = default;
  // acceleration [m/s²], jerk [m/s³], cap of the speed [m/s], all at the handles; dt [s].
  StopProfile(double acceleration, double jerk, double dt,
              double speed_cap = std::numeric_limits<double>::infinity());
  // Begins from the handles' present speed and acceleration along their motion.
  // speed [m/s]: of the faster handle (rotation counted at 0.2 m); rate [m/s²]: its derivative.
  // A speed of zero, or not finite, is at rest at once.
  void Begin(double speed, double rate) noexcept;
  // The factor for the next tick, in [0, kOvershoot]; 0 once at rest.
  double Next() noexcept;
  // Speed [m/s] and rate [m/s²] of the curve, a time [s] after Begin.
  double SpeedAt(double t) const noexcept;
  double RateAt(double t) const noexcept;
  // At rest: the last factor was 0.
  bool done() const noexcept { return done_; }
  // From Begin to rest [s].
  double duration() const noexcept { return ramp_in_ + hold_ + ramp_out_; }
  // From Begin to rest [m].
  double Way() const noexcept;
  double speed() const noexcept { return speed_; }  // at the beginning [m/s]
  double rate() const noexcept { return rate_; }    // [m/s²]
  double rate_now() const noexcept { return RateAt(tick_ * dt_); }
  double jerk() const noexcept { return jerk_; }  // [m/s³]
  void Archive(StateArchive& a) noexcept {
    a(acceleration_, jerk_, dt_, cap_, speed_, rate_, peak_, ramp_in_, hold_, ramp_out_, tick_,
      done_);
  }

 private:
  double acceleration_ = 5, jerk_ = 250, dt_ = 0.001;
  double cap_ = std::numeric_limits<double>::infinity();
  double speed_ = 0, rate_ = 0;                   // at the beginning [m/s], [m/s²]
  double peak_ = 0;                               // largest deceleration [m/s²]
  double ramp_in_ = 0, hold_ = 0, ramp_out_ = 0;  // until it is reached, held, let go [s]
  int tick_ = 0;
  bool done_ = true;
};

// One arm's part of a stop: the common profile, or less braking than that where the other arm is
// still to come. It never speeds up for it, and keeps to the profile's bounds.
class BrakeShare {
 public:
  BrakeShare() = default;
  // hold: for so long it does not brake yet [s].
  BrakeShare(const StopProfile& begun, double hold, double dt);
  // The factor for the next tick. common, rate: the profile's factor there, and its rate [m/s²];
  // behind: by which share of the first speed this arm has to be faster than that, to keep up with
  // the other.
  double Next(double common, double rate, double behind) noexcept;
  // To rest, if it brakes as hard as may be from now on [m].
  double FurtherWay() const noexcept;
  bool done() const noexcept { return factor_ == 0; }
  double factor() const noexcept { return factor_; }  // the last one
  void Archive(StateArchive& a) noexcept { a(brake_, first_, hold_, rate_, dt_, factor_, apart_); }

 private:
  StopProfile brake_;
  double first_ = 0;   // speed at the beginning [m/s]
  double hold_ = 0;    // left [s]
  double rate_ = 0;    // [m/s²]
  double dt_ = 0.001;  // [s]
  double factor_ = 0;
  bool apart_ = false;  // it has left the common profile
};

// What is told of a stop.
struct StopReport {
  Status status;        // cause, hand, value, limit
  double time = 0;      // of the decision [s]
  double duration = 0;  // from the decision until the handles rest; so far, until done [s]
  double distance = 0;  // path of the handle that went further meanwhile [m]
};

// The handles where the arms will be when they obey the next command. Written by the emulator.
struct StopGeometry {
  std::array<Jacobian, kHands> J;    // of each handle, axes of W; without columns: not known
  std::array<Vector3, kHands> p_WH;  // [m]
  // Of the handles, as measured; only where both arms' samples can be trusted.
  bool measured = false;
  std::array<Twist, kHands> V_W = {Twist::Zero(), Twist::Zero()};
};

// Carries out one stop, from the decision to rest. In each tick from the decision on: Observe with
// where the handles are (in the first: where the way begins), then Next for the command.
//
// Stops follow the slower arm: the one that goes on for less after its commands begins to brake
// later by the difference, and one whose handle has gone less far than the other, each measured by
// how it went when the stop began, brakes less until they are even again; an arm that comes to
// where its velocities lead counts by them, since what it is late or early it makes up for. What an
// arm may go further for that is bounded by kMostFollowing.
class StopController {
 public:
  // bounds: of the joints, which the stop keeps to as well: where the handles' deceleration would
  // need more than a joint's acceleration, both arms brake more gently rather than part. lags: of
  // the arms behind their commands [s]. coasting: the way by which each goes on after its commands
  // rest, as time at the speed before [s]; if not given, the lags.
  StopController(const SafetySpec& safety, const std::array<JointBounds, kHands>& bounds, double dt,
                 const std::array<double, kHands>& lags = {});
  StopController(const SafetySpec& safety, const std::array<JointBounds, kHands>& bounds, double dt,
                 const std::array<double, kHands>& lags,
                 const std::array<double, kHands>& coasting);

  // Latches what is wrong and begins to brake. While a stop is in progress or done, until Reset, a
  // further one only tells its cause, if there was none: the first is what a person must hear.
  // time: of the decision [s]. last_command: last sent [rad/s]. handle_speed [m/s], handle_rate
  // [m/s²]: of the faster handle, as StopProfile::Begin; a speed that is not finite counts as the
  // cap. handle_twists: that the last command gave the handles; if not given, taken from the first
  // geometry. No heap, no throw.
  void Begin(const Status& cause, double time, const std::array<JointVector, kHands>& last_command,
             double handle_speed, double handle_rate,
             const std::array<Twist, kHands>* handle_twists = nullptr) noexcept;
  // Next command: the last one before the stop, scaled; zero once the profile is done. No heap, no
  // throw. ticks: since the last command; more than 1 after missed deadlines, since a stop goes by
  // time. What geometry has corrected so far stays.
  void Next(std::array<JointVector, kHands>* v, int ticks = 1) noexcept;
  // The same, corrected for what the arms' changing geometry would make of it: the twists of the
  // handles are scaled, as those of one rigid body, so that they keep their relative pose. The
  // correction is small (second order in the way so far) and bounded.
  void Next(const StopGeometry& geometry, std::array<JointVector, kHands>* v,
            int ticks = 1) noexcept;
  // Poses of the handles, in W, absent ones constant. They rest once the command does and none
  // moves, or turns at kHandleLength, by more than kRest during kRestTime; kPatience after the
  // command the stop counts as done in any case, since what moves then is not the arms' doing.
  // in_motion: a driver has its arm move still, to lead it to rest: then it does not rest.
  void Observe(const std::array<Pose, kHands>& X_WH, bool in_motion = false) noexcept;
  // Further apart than a handle at rest may be, in position or turned.
  static bool Moved(const Pose& from, const Pose& to) noexcept;
  void Reset() noexcept;

  bool active() const noexcept { return active_; }  // begun, until Reset
  bool done() const noexcept { return done_; }      // the handles rest, or patience is over
  // They do not rest though they were told to: done by patience only.
  bool restless() const noexcept { return done_ && restless_; }
  int mover() const noexcept { return mover_; }  // the hand that moved last; −1: none since Begin
  bool commands_rest() const noexcept;
  const StopReport& report() const noexcept { return report_; }
  void Archive(StateArchive& a) noexcept {
    a(profile_, shares_, gone_, followed_, way_left_, after_, report_.status, report_.time,
      report_.duration, report_.distance, command_, corrected_, twist_, begun_, twists_known_,
      twists_split_, corner_, still_, path_, ticks_, rest_ticks_, still_ticks_, active_, done_,
      restless_, seen_, mover_);
    if (mover_ < -1 || mover_ >= kHands) a.Fail();
  }

  static constexpr double kRest = 5e-5;      // [m]: 2.5 mm/s over kRestTime
  static constexpr double kRestTime = 0.02;  // [s]
  static constexpr double kPatience = 0.5;   // [s]
  static constexpr double kPathStep = 1e-4;  // the path is measured in steps of this [m], or the
                                             // encoders' quanta would add up

  static constexpr double kMostCorrection = 0.5;  // of the scaled command's size
  // Of the joints' acceleration, for scaling; the rest is for the correction.
  static constexpr double kShareOfJoints = 0.75;
  // By which an arm goes further than it would alone, at most, as time at the speed at which the
  // stop began [s]: 7.5 mm at 0.25 m/s. And for so long after the profile is done [s].
  static constexpr double kMostFollowing = 0.030, kMostFollowingTime = 0.100;

 private:
  double Allowance(JointVector JointBounds::*bound, double share, double handle_speed,
                   double most) const noexcept;
  void BeginTwists(const StopGeometry& geometry) noexcept;
  std::array<double, kHands> Behind(const StopGeometry& geometry, int ticks) noexcept;
  std::array<double, kHands> NextFactors(const StopGeometry* geometry, int ticks) noexcept;

  SafetySpec safety_;
  std::array<JointBounds, kHands> bounds_;
  double dt_;
  std::array<double, kHands> lags_, coasting_;  // [s]
  StopProfile profile_;
  std::array<BrakeShare, kHands> shares_;
  std::array<double, kHands> gone_ = {};  // of each handle, as time at its first speed [s]
  // Of each command, beyond the profile's way, as time at the first speed [s].
  std::array<double, kHands> followed_ = {};
  double way_left_ = 0;  // of the profile [m]
  double after_ = 0;     // since the profile is done [s]
  StopReport report_;
  std::array<JointVector, kHands> command_;    // last sent before the stop [rad/s]
  std::array<JointVector, kHands> corrected_;  // the same, as geometry has corrected it
  std::array<Twist, kHands> begun_ = {Twist::Zero(), Twist::Zero()};  // of the handles, by it
  std::array<Twist, kHands> twist_ = begun_;                          // the same, split
  bool twists_known_ = false;
  bool twists_split_ = false;  // the right one is relative to what it has with the left
  std::array<Vector3, kHands> corner_ = {Vector3::Zero(), Vector3::Zero()};  // of the path, last
  std::array<Pose, kHands> still_;                                           // where rest is judged
  std::array<double, kHands> path_ = {};                                     // [m]
  int ticks_ = 0, rest_ticks_ = 0, still_ticks_ = 0;
  int mover_ = -1;
  bool active_ = false, done_ = false, restless_ = false, seen_ = false;
};

}  // namespace predictor
