// The states of a run and its permitted transitions, as one small table without dependencies
// (docs/concepts/states.md).
#pragma once

#include <array>
#include <cstdint>

#include "core/status.h"

namespace predictor {

// The events of a run, and who may cause them. The receiver of a request checks whether the sender
// may make the request. The table only contains the next state.
enum class RunEvent : std::uint8_t {
  kStarted,           // program: process up, device answers
  kSelfTestPassed,    // program: sensors tared, samples fresh
  kAlignRequested,    // a person at the rig (simulated rig: the program)
  kAligned,           // program: handles within tolerance, simulation frozen
  kStartRequested,    // a person at the rig (simulated rig: the program)
  kStopRequested,     // anyone, or the monitor on a fault: stop and hold (S2)
  kStopAndPowerOff,   // monitor, or program: a stop that must end without power (S1, S0)
  kStandstill,        // program: both arms at rest
  kReset,             // only a person at the rig, once the cause is gone
  kRecoverRequested,  // only a person at the rig: jog away from a limit
  kRecovered,         // program: within limits again, and released
};
inline constexpr int kRunEvents = 11;

// Returns a name such as "started" or "self-test passed", as in docs/concepts/states.md.
const char* Name(RunEvent event);

// The severity of the present or completed stop. The levels are ordered, and the most severe level
// takes precedence.
enum class StopLevel : std::uint8_t { kNone, kHold, kPowerOff };

// A state and, for a stop, the way in which the stop must end.
struct RunCondition {
  RunState state = RunState::kInit;
  StopLevel level = StopLevel::kNone;
  bool operator==(const RunCondition&) const = default;
};

// Returns a name such as "RUN", "STOPPING" or "STOPPING (power off)".
const char* Name(RunCondition condition);

struct Transition {
  RunCondition from;
  RunEvent event;
  RunCondition to;
};

// The conditions of a run. STOPPING occurs twice, once for each state in which it can end. RECOVERY
// also occurs twice, because after a stop it leads back to HELD.
inline constexpr std::array<RunCondition, kRunStates + 2> kRunConditions = {{
    {RunState::kInit, StopLevel::kNone},
    {RunState::kSelfTest, StopLevel::kNone},
    {RunState::kIdle, StopLevel::kNone},
    {RunState::kAlign, StopLevel::kNone},
    {RunState::kArmed, StopLevel::kNone},
    {RunState::kRun, StopLevel::kNone},
    {RunState::kRecovery, StopLevel::kNone},
    {RunState::kRecovery, StopLevel::kHold},
    {RunState::kStopping, StopLevel::kHold},
    {RunState::kStopping, StopLevel::kPowerOff},
    {RunState::kHeld, StopLevel::kHold},
    {RunState::kUnpowered, StopLevel::kPowerOff},
}};

namespace internal {
inline constexpr RunCondition kInit = kRunConditions[0], kSelfTest = kRunConditions[1],
                              kIdle = kRunConditions[2], kAlign = kRunConditions[3],
                              kArmed = kRunConditions[4], kRun = kRunConditions[5],
                              kRecovery = kRunConditions[6], kRecoveryHeld = kRunConditions[7],
                              kStopping = kRunConditions[8], kStoppingPowerOff = kRunConditions[9],
                              kHeld = kRunConditions[10], kUnpowered = kRunConditions[11];
}  // namespace internal

// This table contains the permitted transitions. Next decides the transitions that the table does
// not contain. Before the self-test has passed, and after the power was off, IDLE can be reached
// only by the self-test. A stop in INIT or SELFTEST therefore ends without power.
inline constexpr std::array kTransitions = {
    Transition{internal::kInit, RunEvent::kStarted, internal::kSelfTest},
    Transition{internal::kInit, RunEvent::kStopRequested, internal::kStoppingPowerOff},
    Transition{internal::kInit, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kSelfTest, RunEvent::kSelfTestPassed, internal::kIdle},
    Transition{internal::kSelfTest, RunEvent::kStopRequested, internal::kStoppingPowerOff},
    Transition{internal::kSelfTest, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kIdle, RunEvent::kAlignRequested, internal::kAlign},
    Transition{internal::kIdle, RunEvent::kRecoverRequested, internal::kRecovery},
    Transition{internal::kIdle, RunEvent::kStopRequested, internal::kStopping},
    Transition{internal::kIdle, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kAlign, RunEvent::kAligned, internal::kArmed},
    Transition{internal::kAlign, RunEvent::kAlignRequested, internal::kAlign},  // repeated request
    Transition{internal::kAlign, RunEvent::kStopRequested, internal::kStopping},
    Transition{internal::kAlign, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kArmed, RunEvent::kStartRequested, internal::kRun},
    Transition{internal::kArmed, RunEvent::kStopRequested, internal::kStopping},
    Transition{internal::kArmed, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kRun, RunEvent::kStartRequested, internal::kRun},  // repeated request
    Transition{internal::kRun, RunEvent::kStopRequested, internal::kStopping},
    Transition{internal::kRun, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kRecovery, RunEvent::kRecovered, internal::kIdle},
    Transition{internal::kRecovery, RunEvent::kRecoverRequested, internal::kRecovery},
    Transition{internal::kRecovery, RunEvent::kStopRequested, internal::kStopping},
    Transition{internal::kRecovery, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    // After a stop that leaves a hand loaded, RECOVERY frees the hand before the cause of the stop
    // can be reset.
    Transition{internal::kRecoveryHeld, RunEvent::kRecovered, internal::kHeld},
    Transition{internal::kRecoveryHeld, RunEvent::kRecoverRequested, internal::kRecoveryHeld},
    Transition{internal::kRecoveryHeld, RunEvent::kStopRequested, internal::kStopping},
    Transition{internal::kRecoveryHeld, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},

    Transition{internal::kStopping, RunEvent::kStandstill, internal::kHeld},
    Transition{internal::kStopping, RunEvent::kStopAndPowerOff, internal::kStoppingPowerOff},
    Transition{internal::kStoppingPowerOff, RunEvent::kStandstill, internal::kUnpowered},

    Transition{internal::kHeld, RunEvent::kReset, internal::kIdle},
    Transition{internal::kHeld, RunEvent::kRecoverRequested, internal::kRecoveryHeld},
    Transition{internal::kHeld, RunEvent::kStopAndPowerOff, internal::kUnpowered},
    Transition{internal::kUnpowered, RunEvent::kReset, internal::kSelfTest},
};

// Returns the next condition. If the table does not contain the event, the program has lost track
// of the state of the run. If an event that the table does not contain occurs while the arms follow
// a task, the event stops them and requests power-off. In any other state, an event that the table
// does not contain changes nothing.
constexpr RunCondition Next(RunCondition from, RunEvent event) noexcept {
  for (const Transition& t : kTransitions) {
    if (t.from == from && t.event == event) return t.to;
  }
  return FollowsTask(from.state) ? internal::kStoppingPowerOff : from;
}

class StateMachine {
 public:
  RunState state() const noexcept { return condition_.state; }
  // Returns the level of the present or completed stop, or kNone without a stop. Only kReset lowers
  // it.
  StopLevel level() const noexcept { return condition_.level; }
  // Applies Next. Returns whether state or level changed.
  bool Handle(RunEvent event) noexcept {
    const RunCondition before = condition_;
    condition_ = Next(before, event);
    return condition_ != before;
  }
  // Returns whether simulated time advances. Simulated time advances only in RUN.
  static constexpr bool TimePasses(RunState state) noexcept { return state == RunState::kRun; }
  template <class A>
  void Archive(A& a) noexcept {
    a(condition_.state, condition_.level);
    for (const RunCondition& known : kRunConditions)
      if (known == condition_) return;
    a.Fail();
  }

 private:
  RunCondition condition_;
};

}  // namespace predictor
