// The values of one tick, in the order in which its stages compute them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/messages.h"
#include "core/record.h"
#include "rig/operator.h"
#include "safety/state_machine.h"

namespace predictor {

// Requests of people and programs since the last tick.
struct RunRequests {
  std::uint32_t events = 0;  // bit = RunEvent
  bool end = false;          // bring the arms to rest, without a fault

  bool Has(RunEvent event) const noexcept { return (events >> static_cast<int>(event) & 1U) != 0; }
  std::uint16_t recorded() const noexcept {
    return static_cast<std::uint16_t>(events | (end ? kEndRequest : 0U));
  }
};

// The joint velocities that were last sent, and the resulting motion of the handles.
struct SentMotion {
  std::array<JointVector, kHands> v;  // [rad/s]
  bool may_rest_next = true;          // the next command may be zero
  std::array<Twist, kHands> handle_twist = {Twist::Zero(), Twist::Zero()};  // V_WH
  double handle_speed = 0;  // speed of the faster handle, as measured by StopSpeed [m/s]
  double handle_rate = 0;   // derivative of handle_speed [m/s²]
};

// The largest speed [m/s] and angular speed [rad/s] of a handle.
struct HandleCap {
  double speed = HUGE_VAL, rotation = HUGE_VAL;
};

// The work of the pipeline in this tick. The supervisor writes this value before sensing.
struct TickPlan {
  RunState state = RunState::kInit;
  bool wrench_known = false;  // the tared sensors measure the wrenches of the hands
  bool waiting = false;       // an arm's controller has not started the motion yet
  bool time_passes = false;   // the virtual world moves
  bool renders = false;       // the QP is solved
  HandleCap cap;
  double run_time = 0;                        // [s]
  std::array<HandInput, kHands> hand_inputs;  // inputs of a person at a page
  std::optional<ControllerTuning> tuning;     // set if a parameter changed
};

enum class Motion : std::uint8_t {
  kNone,     // the arms are at rest
  kFollow,   // follow the virtual handles, as rendered
  kBrake,    // execute a stop
  kRecover,  // RECOVERY
};

// The motion of the arms in this tick. The supervisor writes this value after its checks.
struct MotionOrder {
  Motion motion = Motion::kNone;
  bool holds = false;  // following or recovering, but with zero velocity commanded
  HandleCap cap;
  int ticks = 1;  // ticks since the last command; more than 1 only if braking is late
};

// Each stage reads the values that the previous stages wrote. Values that a stage does not write
// keep their values from the previous tick.
struct TickData {
  std::uint32_t missed = 0;  // consecutive missed deadlines, as reported by the loop
  RunRequests requests;

  // Read
  DeviceSample sample;
  OperatorOutput person;  // the simulated operator, at the time of the sample
  Status reading;
  // Sense
  std::array<FrameMotion, kHands> real;  // measured handles H
  std::array<HandWrench, kHands> wrench;
  Status sensing;
  // Simulate
  WorldState before;                  // the virtual world at the time of the sample
  const WorldState* after = nullptr;  // the virtual world after the step
  Status simulation;
  // Render
  RenderResult rendered;
  Vector3 perturbation = Vector3::Zero();  // commanded displacement of the handles, in W [m]
  Status haptics;
  // Command and write
  DeviceCommand command;
  int guard_altered = 0;  // joints whose command the guard changed
  SentMotion sent;
  Status writing;
};

}  // namespace predictor
