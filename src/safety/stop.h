// Carries out a stop, which brings both arms to rest, and reports the outcome.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/messages.h"
#include "core/rest_detector.h"
#include "safety/arm_brake.h"
#include "safety/guard.h"
#include "safety/stop_profile.h"
#include "scenario/scenario.h"

namespace predictor {

struct StopReport {
  Status status;        // the fault that caused the stop; ok if it has none
  double time = 0;      // run time of the decision [s]
  double duration = 0;  // time from the decision until the handles rest, or until now [s]
};

// The state of the handles at the time when the arms will follow the next command. The pipeline
// writes it.
struct StopGeometry {
  std::array<Jacobian, kHands> J;  // Jacobian of each handle, axes of W; without columns: unknown
  std::array<Vector3, kHands> p_WH = {Vector3::Zero(), Vector3::Zero()};  // [m]
  // The measured twists of the handles. These twists are valid only while the samples of both arms
  // can be trusted.
  bool measured = false;
  std::array<Twist, kHands> V_W = {Twist::Zero(), Twist::Zero()};
};

// Carries out one stop, from the decision to rest. Call Next for the command and Observe with the
// poses of the handles in each tick, beginning with the tick of the decision.
//
// The faster arm waits for the slower one. The arm with the smaller overrun begins to brake later,
// by the difference between the overruns. The program compares the distances that the handles have
// moved, each relative to the handle's speed when the stop began. The arm of the handle with the
// smaller distance brakes less until both distances are equal again. An arm that follows a position
// compensates for its lag, so the comparison uses the arm's commands. kMaxFollowing bounds the
// additional distance that an arm may travel because it follows the other arm.
class StopController {
 public:
  // `bounds` are joint bounds, which a stop respects as well. If the handles' deceleration would
  // need more than a joint's acceleration, both arms brake more gently and do not separate. `lags`
  // are the times by which the arms lag behind their commands [s]. `overruns` are the distances
  // that the arms travel after their commands reach zero, divided by their speeds before [s]. If
  // the overruns are omitted, they are equal to the lags.
  StopController(const SafetySpec& safety, const std::array<JointBounds, kHands>& bounds, double dt,
                 const std::array<double, kHands>& lags = {});
  StopController(const SafetySpec& safety, const std::array<JointBounds, kHands>& bounds, double dt,
                 const std::array<double, kHands>& lags,
                 const std::array<double, kHands>& overruns);

  // Latches the fault and begins to brake. Until Reset, a further call has an effect only if the
  // stop has no fault yet, because the operator must see the first fault. `time` is the time of the
  // decision [s]. `last_command` is the last command that was sent [rad/s]. `handle_speed` [m/s]
  // and `handle_rate` [m/s²] are the speed of the faster handle and its derivative, as for
  // StopProfile::Begin. A speed that is not finite is replaced by the cap. `handle_twists` are the
  // twists of the handles due to the last command. If the twists are omitted, they are computed
  // from the first geometry. Does not use the heap or throw.
  void Begin(const Status& cause, double time, const std::array<JointVector, kHands>& last_command,
             double handle_speed, double handle_rate,
             const std::array<Twist, kHands>* handle_twists = nullptr) noexcept;
  // Computes the next command. This command is the last command before the stop, scaled by the
  // profile's factor, or zero once the profile has ended. `ticks` is the number of ticks since the
  // last command. After missed deadlines, it is more than 1, because a stop follows elapsed time.
  // The function keeps the corrections that were made for earlier geometries. Does not use the heap
  // or throw.
  void Next(std::array<JointVector, kHands>* v, int ticks = 1) noexcept;
  // Computes the next command, corrected for the change of the arms' geometry. The twists of the
  // handles are scaled like the twists of two points of one rigid body, so that the handles keep
  // their relative pose. The correction is bounded and small, because it is of second order in the
  // distance that the arms have covered.
  void Next(const StopGeometry& geometry, std::array<JointVector, kHands>* v,
            int ticks = 1) noexcept;
  // `X_WH` are the poses of the handles in W, which are constant for absent handles. `in_motion`
  // states whether a driver still moves its arm. The handles are at rest once the commands are zero
  // and no handle has moved (RestDetector) for kRestTime. The stop ends when the handles are at
  // rest, or at the latest kPatience after the commands became zero. An arm that still moves at
  // this time does not follow its commands.
  void Observe(const std::array<Pose, kHands>& X_WH, bool in_motion = false) noexcept;
  void Reset() noexcept;

  bool active() const noexcept { return active_; }  // true from Begin until Reset
  bool done() const noexcept { return done_; }  // the handles are at rest, or the stop timed out
  // Returns whether the stop timed out while an arm still moved.
  bool timed_out() const noexcept { return done_ && timed_out_; }
  int mover() const noexcept { return rest_.mover(); }  // hand that moved last; −1: none
  bool commands_rest() const noexcept;
  const StopReport& report() const noexcept { return report_; }
  void Archive(StateArchive& a) noexcept;

  static constexpr double kRestTime = 0.02;  // [s]
  static constexpr double kPatience = 0.5;   // [s]
  // The largest speed at which a handle is regarded as at rest [m/s].
  static constexpr double kMaxRestSpeed = RestDetector::kMaxMotion / kRestTime;

  static constexpr double kMaxCorrection = 0.5;  // as a share of the scaled command's norm
  // The share of the joints' acceleration that scaling uses. The rest of the acceleration is
  // reserved for the correction.
  static constexpr double kShareOfJoints = 0.75;
  // The first constant limits the extra distance that an arm travels compared with a stop of this
  // arm alone. This distance is divided by the speed at which the stop began [s] (7.5 mm at 0.25
  // m/s). The second constant is the time for which an arm follows the other arm after the profile
  // has ended [s].
  static constexpr double kMaxFollowing = 0.030, kMaxFollowingTime = 0.100;

 private:
  double Allowance(JointVector JointBounds::*bound, double share, double handle_speed,
                   double max) const noexcept;
  void BeginTwists(const StopGeometry& geometry) noexcept;
  std::array<double, kHands> Behind(const StopGeometry& geometry, int ticks) noexcept;
  std::array<double, kHands> NextFactors(const StopGeometry* geometry, int ticks) noexcept;
  // Returns whether the arm follows a position. The overrun of an arm that follows a position is
  // shorter than its lag.
  bool MakesUp(std::size_t arm) const noexcept { return overruns_[arm] < lags_[arm]; }

  SafetySpec safety_;
  std::array<JointBounds, kHands> bounds_;
  double dt_;
  std::array<double, kHands> lags_, overruns_;  // [s]
  StopReport report_;
  bool active_ = false, done_ = false, timed_out_ = false;

  // Braking
  StopProfile profile_;
  std::array<ArmBrake, kHands> brakes_;
  double profile_left_ = 0;                    // distance that remains [m]
  std::array<JointVector, kHands> command_;    // last sent before the stop [rad/s]
  std::array<JointVector, kHands> corrected_;  // the last command, corrected for the geometry
  // The twists of the handles due to the last command.
  std::array<Twist, kHands> begun_ = {Twist::Zero(), Twist::Zero()};
  std::array<Twist, kHands> twist_ = begun_;  // the twists of the last command, split
  bool twists_known_ = false;
  bool twists_split_ = false;  // the right twist is relative to its rigid-body share

  // The quantities from which the program computes how an arm waits for the other arm. A distance
  // is given as the time in which the handle travels this distance at its initial speed [s].
  std::array<double, kHands> gone_ = {};      // distance of each handle
  std::array<double, kHands> followed_ = {};  // distance of each command beyond the profile's
  double after_ = 0;                          // time since the end of the profile [s]

  // Rest
  RestDetector rest_;
  bool seen_ = false;  // the handles' poses have been observed
  int ticks_ = 0, rest_ticks_ = 0, still_ticks_ = 0;
};

}  // namespace predictor
