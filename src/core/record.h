// One tick as everyone outside it sees it: recorder, viewer, evaluation, terminal.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/run_input.h"
#include "core/status.h"
#include "core/types.h"

namespace predictor {

// Where a tick's time goes. kTick is the whole.
enum class Stage : int { kRead, kSense, kSimulate, kRender, kMonitor, kGuard, kWrite, kTick };
inline constexpr int kStages = 8;
inline constexpr std::array<const char*, kStages> kStageNames = {
    "read", "sense", "simulate", "render", "monitor", "guard", "write", "tick"};

// Inputs that one tick takes; more wait for the next.
inline constexpr int kInputsPerTick = 4;

// Position [m], then quaternion, scalar first (Hamilton).
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
  std::uint8_t gripping;  // simulated person only: s > 0.5; else 1 while RUN
  std::uint8_t arm_dof;
  std::uint8_t sensor_saturated;
  std::uint8_t arm_fault;  // the arm reports a fault
  std::uint8_t warnings;   // in force, bit = Warning
  // Joints whose bound held the command back, bit = joint: position, velocity or acceleration.
  std::uint16_t at_lower, at_upper;
  std::uint8_t arm_in_motion;  // its driver has it move still, whatever it was told
  std::uint8_t arm_waits;      // it does not obey yet: its controller has not begun to
  std::array<std::uint8_t, 4> more_reserved;
  MotionRecord real;                            // H, measured; in direct mode equal to D
  MotionRecord virtual_;                        // D, at the time of the same sample
  std::array<double, 6> wrench_raw;             // sensor's reading, axes of S [N, N·m]
  std::array<double, 6> wrench;                 // F_H_W, estimated [N, N·m]
  std::array<double, 6> coupling;               // on D, axes of W [N, N·m]
  std::array<double, kMaxArmJoints> q, v;       // measured [rad], [rad/s]
  std::array<double, kMaxArmJoints> command;    // sent [rad/s]
  std::array<double, 6> true_wrench;            // simulated rig only: the hand's true wrench F_H_W
  double arm_age, sensor_age;                   // [s]
  std::uint64_t arm_sequence, sensor_sequence;  // of the device's samples
  double manipulability;
  // By Warning, whether in force or not: share of the arm's samples lost within a second, of the
  // sensor's; packets refused [1/s]; drift of the bias [N/min], as seen last.
  std::array<double, kWarningValues> warning_values;
};

// That warning is in force.
inline bool Has(const HandRecord& hand, Warning warning) noexcept {
  return (hand.warnings >> static_cast<unsigned>(warning) & 1U) != 0;
}

// A Status without padding.
struct StatusRecord {
  StopCause cause;
  std::int8_t hand;
  Quantity quantity;
  std::uint8_t power_off;  // the stop must end without power
  std::array<std::uint8_t, 4> reserved;
  double value, limit;  // SI
};

// The request to end a run, in TickRecord::requests; the other bits are those of RunEvent.
inline constexpr std::uint16_t kEndRequest = 1U << 15U;

// Plain, without padding and trivially copyable, so that it can lie in shared memory and be
// compared byte by byte. With the scenario it holds all that a tick depends on.
struct TickRecord {
  std::uint64_t tick;     // counts from process start
  double run_time;        // simulated time since RUN began [s]
  std::uint64_t wall_ns;  // monotonic clock at the tick's start [ns]; 0 in virtual time
  RunState state;
  StopCause cause;  // latched: of the stop, until reset
  std::int8_t cause_hand;
  std::uint8_t hands_gripping;      // number of hands that grip
  std::int32_t action;              // of the simulated person's script; −1 none
  double cause_value, cause_limit;  // SI
  Quantity cause_quantity;          // of both
  std::uint8_t ran;  // the tick began in RUN: simulated time passed, also if a stop was decided
  std::uint8_t rendered;     // a QP was solved or tried in this tick
  std::uint8_t input_count;  // of `inputs`
  std::uint32_t missed;      // deadlines in a row, as the loop said
  std::uint16_t requests;    // taken at this tick: bit = RunEvent, or kEndRequest
  std::uint16_t qp_rows;     // of the limits, in their order, that were active: bit = row
  std::uint8_t refused;      // of the requests: 1 + RunEvent of the last that was not granted, or 0
  std::uint8_t why_refused;  // Refusal
  std::array<std::uint8_t, 2> reserved;
  StatusRecord read, written;  // what the device answered
  StatusRecord
      harder;  // what took the power off at the end of a stop that would have held; latched
  std::array<RunInput, kInputsPerTick> inputs;  // of people and pages, taken in this tick
  std::array<double, kParameters> parameters;   // as they are now, by Parameter
  std::array<HandRecord, kHands> hands;
  std::uint8_t cobot_dof;
  std::uint8_t qp_relaxed, qp_failed, guard_altered;
  std::int32_t qp_iterations;
  std::array<double, kMaxCobotJoints> cobot_q, cobot_v, cobot_torque;  // [rad], [rad/s], [N·m]
  MotionRecord object, end_effector;                                   // O and E, in W
  std::array<double, 6> relative_slack;                                // [m/s, rad/s]
  double elbow_slack;                                                  // [m/s]
  double elbow_distance;  // [m]; +inf without link pairs, and before the first QP
  double energy;          // of the virtual world [J]
  double kkt_residual;
  std::array<float, kStages> stage_us;  // [µs]
};
static_assert(std::is_trivially_copyable_v<TickRecord>);

StatusRecord ToRecord(const Status& status);
Status FromRecord(const StatusRecord& r);
PoseRecord ToRecord(const Pose& X);
Pose FromRecord(const PoseRecord& r);

}  // namespace predictor
