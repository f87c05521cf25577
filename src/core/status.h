// What a tick may report: never an exception, never a string built at run time.
#pragma once

#include <cstdint>

namespace predictor {

// Why a run was stopped. The names, in this order, are those of the summary's "stop.cause".
enum class StopCause : std::uint8_t {
  kNone,
  kForce,        // hand force above its threshold
  kTorque,       // hand torque above its threshold
  kSensor,       // reading not finite, saturated, or flagged by the sensor
  kStale,        // a sample is too old or frozen
  kTracking,     // real handle too far from the virtual one, or relative slack too large
  kCoupling,     // coupling wrench above its limit
  kElbow,        // a link pair nearer than its security distance
  kJoint,        // a joint beyond its limits
  kOscillation,  // growing oscillation of a hand's force
  kQp,           // no feasible command
  kPhysics,      // the simulation's step was not finite or diverged
  kDeadline,     // ticks missed
  kDevice,       // the device reported a fault or refused
  kOperator,     // a person asked for the stop
  kHeadset,      // a headset sends no more frames: its wearer does not see what the arms do
  kEnabling,     // with real arms: nobody holds the enabling key or button (any more)
  kRunaway,      // a handle runs away with its own hand: the sensor reads mirrored
};
inline constexpr int kStopCauses = 18;

// Name as in the summary ("force", "torque", ...); "none" for kNone.
const char* Name(StopCause cause);

// What a value and its limit measure.
enum class Quantity : std::uint8_t {
  kNone,          // nothing to be told in numbers
  kCount,         // of ticks, readings or joints
  kForce,         // [N]
  kTorque,        // [N·m]
  kLength,        // [m]
  kAngle,         // [rad]
  kSpeed,         // [m/s]
  kAngularSpeed,  // [rad/s]
  kTime,          // [s]
  kArmAge,        // of an arm's sample [s]
  kSensorAge,     // of a force sensor's reading [s]
};
inline constexpr int kQuantities = 11;

// What a cause is measured by, where nothing else is said.
constexpr Quantity UsualQuantity(StopCause cause) {
  switch (cause) {
    case StopCause::kForce:
    case StopCause::kOscillation:
    case StopCause::kCoupling:
      return Quantity::kForce;
    case StopCause::kTorque:
      return Quantity::kTorque;
    case StopCause::kTracking:
    case StopCause::kElbow:
      return Quantity::kLength;
    case StopCause::kJoint:
      return Quantity::kAngle;
    case StopCause::kRunaway:
      return Quantity::kSpeed;
    case StopCause::kStale:
    case StopCause::kHeadset:
    case StopCause::kEnabling:
      return Quantity::kTime;
    case StopCause::kQp:
    case StopCause::kDeadline:
      return Quantity::kCount;
    default:
      return Quantity::kNone;
  }
}

// Outcome of a step of the tick: what is wrong, on which side, how much of which limit.
struct [[nodiscard]] Status {
  StopCause cause = StopCause::kNone;
  std::int8_t hand = -1;                     // 0 left, 1 right, −1 neither or both
  double value = 0;                          // what was seen, SI
  double limit = 0;                          // what is allowed, SI
  Quantity quantity = UsualQuantity(cause);  // of both
  bool power_off = false;                    // the stop must end without power (S1), not hold (S2)

  bool ok() const { return cause == StopCause::kNone; }
  static Status Ok() { return {}; }
};

// What a person is told while nothing stops for it; a bit each in HandRecord::warnings.
enum class Warning : std::uint8_t {
  kArmLoss,     // of the arm's samples too many were lost within a second
  kSensorLoss,  // the same of the sensor
  kRefused,     // what was of a wrong size, unreadable or somebody else's was dropped
  kBiasDrift,   // the sensor's reading drifts though nothing touches the handle
  kNoPowerOff,  // the arm cannot be asked to cut its power any more
  kKeepsPower,  // it was to be without power, and says that it is not
};
inline constexpr int kWarnings = 6;
inline constexpr int kWarningValues = 4;  // of the first ones; the others are so or are not

// States of a run; what each means is told in docs/states.md.
enum class RunState : std::uint8_t {
  kInit,
  kSelfTest,
  kIdle,
  kAlign,
  kArmed,
  kRun,
  kStopping,
  kHeld,
  kUnpowered,
  kRecovery,
};
inline constexpr int kRunStates = 10;

// "INIT", "SELFTEST", ...
const char* Name(RunState state);

// States in which the arms follow a task; STOPPING moves too, but only towards rest.
constexpr bool FollowsTask(RunState state) noexcept {
  return state == RunState::kAlign || state == RunState::kRun || state == RunState::kRecovery;
}
// States in which velocities other than zero may be sent.
constexpr bool MayMove(RunState state) noexcept {
  return FollowsTask(state) || state == RunState::kStopping;
}

// Why a request was not granted.
enum class Refusal : std::uint8_t {
  kNone,
  kNotEnabled,    // with real arms: nobody holds the enabling key
  kBeyondJoint,   // a joint is beyond its limit: RECOVERY first
  kBeyondLinks,   // two links are nearer than the security distance: RECOVERY first
  kCauseRemains,  // what the run was stopped for is still there, or has just gone
  kHandLoaded,    // somebody or something presses on a handle
  kNotFree,       // the same where hands must be off, unless a sensor has drifted
  kMoves,         // an arm does not stand: it is led, or sinks
  kNotAligned,    // a handle is no longer where aligning brought it
};
inline constexpr int kRefusals = 9;
// A sentence for a person, and what to do; "" for none.
const char* Sentence(Refusal refusal);

}  // namespace predictor
