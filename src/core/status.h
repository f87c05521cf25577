// Faults and states that a tick may report. Faults and states are enumerations and numbers, never
// exceptions or text.
#pragma once

#include <cstdint>

namespace predictor {

// Cause of a stop. The summary uses the names, in this order, for "stop.cause".
enum class StopCause : std::uint8_t {
  kNone,
  kForce,         // hand force above its threshold
  kTorque,        // hand torque above its threshold
  kSensor,        // reading not finite, saturated, or flagged by the sensor
  kStale,         // a sample is too old, or samples are frozen
  kTracking,      // real handle too far from the virtual one, or relative slack too large
  kCoupling,      // coupling wrench above its limit
  kLinkDistance,  // a link pair nearer than its security distance
  kJoint,         // a joint beyond its limits
  kOscillation,   // growing oscillation or vibration of a hand's force (by quantity)
  kQp,            // no feasible command
  kPhysics,       // the simulation step was not finite or diverged
  kDeadline,      // ticks were missed, or the computer was suspended (the value is then in seconds)
  kDevice,        // the device reported a fault or refused a command
  kOperator,      // a person requested the stop
  kHeadset,       // a headset stopped sending frames, so its wearer does not see the arms move
  kEnabling,      // real arms: the enabling key or button was released
  kRunaway,       // a handle runs away with the hand because the sensor's axes are mirrored
  kWatchdog,      // real arms: the watchdog is silent
};
inline constexpr int kStopCauses = 19;

// Returns the name as in the summary ("force", "torque", ...), or "none" for kNone.
const char* Name(StopCause cause);

// Quantity to which a measured value and its limit belong.
enum class Quantity : std::uint8_t {
  kNone,                 // no number
  kCount,                // of ticks, readings or joints
  kForce,                // [N]
  kTorque,               // [N·m]
  kLength,               // [m]
  kAngle,                // [rad]
  kSpeed,                // [m/s]
  kAngularSpeed,         // [rad/s]
  kTime,                 // [s]
  kArmAge,               // of an arm's sample [s]
  kSensorAge,            // of a force sensor's reading [s]
  kVibration,            // amplitude of a force's vibration [N]
  kAcceleration,         // [m/s²]
  kAngularAcceleration,  // [rad/s²]
  kNotFinite,            // no number, because the simulation step has no finite result
  kAllocations,          // of heap memory: calls that allocate or free it
};
inline constexpr int kQuantities = 16;

// Returns the quantity that belongs to a cause. The Status of the cause may name another quantity,
// which then takes precedence.
constexpr Quantity UsualQuantity(StopCause cause) {
  switch (cause) {
    case StopCause::kForce:
    case StopCause::kOscillation:
    case StopCause::kCoupling:
      return Quantity::kForce;
    case StopCause::kTorque:
      return Quantity::kTorque;
    case StopCause::kTracking:
    case StopCause::kLinkDistance:
      return Quantity::kLength;
    case StopCause::kJoint:
      return Quantity::kAngle;
    case StopCause::kRunaway:
      return Quantity::kSpeed;
    case StopCause::kStale:
    case StopCause::kHeadset:
    case StopCause::kEnabling:
    case StopCause::kWatchdog:
      return Quantity::kTime;
    case StopCause::kQp:
    case StopCause::kDeadline:
      return Quantity::kCount;
    default:
      return Quantity::kNone;
  }
}

// The way in which the virtual cobot's controller obtained its torques. Values other than kComputed
// occur only for a controller outside the program.
enum class ControllerOutcome : std::uint8_t {
  kComputed,
  kFellBack,  // the controller was late: gravity compensation and damping acted instead
  kFailed,    // no usable torques: the step was refused
};
inline constexpr int kControllerOutcomes = 3;

// Outcome of a step of the tick: the fault, the side where it occurred, the measured value and its
// limit.
struct [[nodiscard]] Status {
  StopCause cause = StopCause::kNone;
  std::int8_t hand = -1;                     // 0 left, 1 right, −1 neither or both
  double value = 0;                          // measured, SI
  double limit = 0;                          // allowed, SI
  Quantity quantity = UsualQuantity(cause);  // quantity of value and limit
  bool power_off = false;                    // the stop must cut the power (S1), not hold (S2)

  bool ok() const { return cause == StopCause::kNone; }
  static Status Ok() { return {}; }
};

// Conditions that are reported to the operator but do not stop the run. Each condition is a bit of
// HandRecord::warnings.
enum class Warning : std::uint8_t {
  kArmLoss,     // too many of the arm's samples were lost within a second
  kSensorLoss,  // too many of the sensor's samples were lost within a second
  kRefused,  // packets that were unreadable, of the wrong size or from another sender were dropped
  kBiasDrift,   // the sensor's reading drifts although the handle is not touched
  kNoPowerOff,  // the arm no longer accepts a request to cut its power
  kKeepsPower,  // the arm reports that it has power although the power should be off
};
inline constexpr int kWarnings = 6;
inline constexpr int kWarningValues = 4;  // only the first warnings have a value

// The reason why the virtual cobot's own safety functions stopped the cobot.
enum class CobotStop : std::uint8_t { kNone, kForce, kSpeed, kMomentum, kJointTorque };
inline constexpr int kCobotStops = 5;
const char* Name(CobotStop stop);  // "none", "force", ...

// State of the attachment between cobot and object. The attachment holds, slips, is open, or stayed
// open because the object was too far away to be grasped.
enum class AttachmentState : std::uint8_t { kHolds, kSlips, kOpen, kMissed };

// States of a run, as docs/concepts/states.md describes them.
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

// Returns "INIT", "SELFTEST", ...
const char* Name(RunState state);

// Returns whether the arms follow a task in this state. In STOPPING, the arms also move, but only
// until they come to rest.
constexpr bool FollowsTask(RunState state) noexcept {
  return state == RunState::kAlign || state == RunState::kRun || state == RunState::kRecovery;
}
// Returns whether velocities other than zero may be sent in this state.
constexpr bool MayMove(RunState state) noexcept {
  return FollowsTask(state) || state == RunState::kStopping;
}

// The reason why a request was refused.
enum class Refusal : std::uint8_t {
  kNone,
  kNotEnabled,    // real arms: the enabling key is not held
  kBeyondJoint,   // a joint is beyond its limit: RECOVERY first
  kBeyondLinks,   // two links are nearer than the security distance: RECOVERY first
  kCauseRemains,  // the stop's cause is still present or has only just ended
  kHandLoaded,    // a force acts on a handle
  kNotFree,       // a force is measured although the hands must be off (or the sensor has drifted)
  kMoves,         // an arm moves: it is being guided by hand, or it sinks
  kNotAligned,    // a handle has moved away from its aligned pose
};
inline constexpr int kRefusals = 9;
// Returns a sentence with the action that the operator must take, or "" for kNone.
const char* Sentence(Refusal refusal);

}  // namespace predictor
