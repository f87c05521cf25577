// The record of one tick, which the recorder, the viewer, the evaluation and the terminal read. The
// file core/tick_fields.h describes each field. Add new fields there too.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/run_input.h"
#include "core/status.h"
#include "core/types.h"

namespace predictor {

// Stages of a tick whose durations are measured. The value kTick stands for the whole tick.
enum class Stage : int { kRead, kSense, kSimulate, kRender, kMonitor, kGuard, kWrite, kTick };
inline constexpr int kStages = 8;
inline constexpr std::array<const char*, kStages> kStageNames = {
    "read", "sense", "simulate", "render", "monitor", "guard", "write", "tick"};

// Inputs accepted per tick. Any further inputs are processed in the next tick.
inline constexpr int kInputsPerTick = 4;

// Position [m], then quaternion with the scalar first (Hamilton).
struct PoseRecord {
  std::array<double, 3> p;
  std::array<double, 4> q;
};

struct MotionRecord {
  PoseRecord pose;              // in W
  std::array<double, 6> twist;  // in W: linear [m/s], angular [rad/s]
};

struct HandRecord {
  std::uint8_t present;
  std::uint8_t gripping;  // simulated person only: s > 0.5; otherwise 1 during RUN
  std::uint8_t arm_dof;
  std::uint8_t sensor_saturated;
  std::uint8_t arm_fault;  // the arm reports a fault
  std::uint8_t warnings;   // active warnings, bit = Warning
  // Joints for which the bound of the position, velocity or acceleration limited the command. Each
  // bit stands for a joint.
  std::uint16_t at_lower, at_upper;
  std::uint8_t arm_in_motion;  // the driver is still ramping the arm down
  std::uint8_t arm_waits;      // the arm's controller has not started the motion yet
  std::array<std::uint8_t, 4> more_reserved;
  MotionRecord real;                            // H, measured; equal to D in direct mode
  MotionRecord virtual_;                        // D, at the time of the same sample
  std::array<double, 6> wrench_raw;             // sensor's reading, axes of S [N, N·m]
  std::array<double, 6> wrench;                 // F_H_W, estimated [N, N·m]
  std::array<double, 6> coupling;               // on D, axes of W [N, N·m]
  std::array<double, kMaxArmJoints> q, v;       // measured [rad], [rad/s]
  std::array<double, kMaxArmJoints> command;    // sent [rad/s]
  std::array<double, 6> true_wrench;            // simulated rig only: the hand's true wrench F_H_W
  double arm_age, sensor_age;                   // [s]
  std::uint64_t arm_sequence, sensor_sequence;  // counters of the device's samples
  double manipulability;
  // Values for each Warning, whether the warning is active or not. They are the share of the arm's
  // samples lost within a second, the share of the sensor's samples lost within a second, the
  // number of packets refused [1/s], and the last measured drift of the bias [N/min].
  std::array<double, kWarningValues> warning_values;
};

// Returns whether the warning is active.
inline bool Has(const HandRecord& hand, Warning warning) noexcept {
  return (hand.warnings >> static_cast<unsigned>(warning) & 1U) != 0;
}

// The same content as Status, without padding bytes.
struct StatusRecord {
  StopCause cause;
  std::int8_t hand;
  Quantity quantity;
  std::uint8_t power_off;  // the stop must cut the power (S1)
  std::array<std::uint8_t, 4> reserved;
  double value, limit;  // SI
};

// Bit of TickRecord::requests that ends the run. The other bits are the bits of RunEvent.
inline constexpr std::uint16_t kEndRequest = 1U << 15U;

// TickRecord is trivially copyable and has no padding bytes, so it can be placed in shared memory
// and compared byte by byte. A TickRecord, together with the scenario, contains every input of a
// tick.
struct TickRecord {
  std::uint64_t tick;     // counted from the start of the process
  double run_time;        // simulated time since RUN began [s]
  std::uint64_t wall_ns;  // monotonic clock at the tick's start [ns]; 0 in virtual time
  RunState state;
  StopCause cause;  // of the stop; latched until reset
  std::int8_t cause_hand;
  std::uint8_t hands_gripping;      // number of hands that grip
  std::int32_t action;              // action of the operator's script; −1: none
  double cause_value, cause_limit;  // SI
  Quantity cause_quantity;          // quantity of value and limit
  std::uint8_t ran;  // the tick began in RUN, so simulated time passed, even if it decided a stop
  std::uint8_t rendered;       // a QP was solved or tried in this tick
  std::uint8_t input_count;    // number of valid `inputs`
  std::uint32_t missed;        // deadlines missed in a row, counted by the loop
  std::uint16_t requests;      // requests handled in this tick: bit = RunEvent, or kEndRequest
  std::uint16_t qp_rows;       // active rows of the limits: bit = row
  std::uint8_t refused;        // 1 + RunEvent of the last refused request; 0: none
  std::uint8_t why_refused;    // Refusal
  std::uint8_t controller;     // ControllerOutcome of the virtual cobot's last step
  std::uint8_t cobot_stop;     // protective stop of the virtual cobot itself: CobotStop
  std::uint16_t events;        // active hazards: bit = entry of the scenario's `events`
  std::uint8_t latest_event;   // 1 + number of the hazard that began last; 0: none
  std::uint8_t attachment;     // AttachmentState of the cobot's grip on the object
  std::uint8_t movable_count;  // entries of the scenario's environment.objects
  std::uint8_t held;           // 1 + the movable object that the carried object holds; 0: none
  std::uint8_t held_grip;      // AttachmentState of this grip
  std::array<std::uint8_t, 1> reserved;
  StatusRecord read, written;  // result of the device's read and write
  // Latched fault that escalated a stop from hold (S2) to power-off (S1).
  StatusRecord harder;
  std::array<RunInput, kInputsPerTick> inputs;  // from people and pages, taken in this tick
  std::array<double, kParameters> parameters;   // current values, by Parameter
  // Commanded displacement of the real handles relative to the virtual handles, in W [m].
  std::array<double, 3> perturbation;
  std::array<HandRecord, kHands> hands;
  std::uint8_t cobot_dof;
  std::uint8_t qp_relaxed, qp_failed, guard_altered;
  std::int32_t qp_iterations;
  std::array<double, kMaxCobotJoints> cobot_q, cobot_v, cobot_torque;  // [rad], [rad/s], [N·m]
  MotionRecord object, end_effector;                                   // O and E, in W
  std::array<PoseRecord, kMaxMovables> movables;                       // movable objects, in W
  std::array<double, 6> relative_slack;                                // [m/s, rad/s]
  double limit_slack;    // largest relaxation of a limit by the QP [m/s]
  double link_distance;  // of the nearest link pair [m]; +inf without pairs and before the first QP
  double energy;         // of the virtual world [J]
  double kkt_residual;
  std::array<float, kStages> stage_us;  // [µs]
};
static_assert(std::is_trivially_copyable_v<TickRecord>);

StatusRecord ToRecord(const Status& status);
Status FromRecord(const StatusRecord& r);
PoseRecord ToRecord(const Pose& X);
Pose FromRecord(const PoseRecord& r);

}  // namespace predictor
