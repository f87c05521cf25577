// States of a run and who may go where, as one small table without dependencies.
#pragma once

#include <cstdint>

#include "core/status.h"

namespace predictor {

// What can happen to a run.
enum class RunEvent : std::uint8_t {
  kStarted,          // process up, device answers
  kSelfTestPassed,   // sensors tared, samples fresh
  kAlignRequested,   // a person (simulated rig: the program) asks to align
  kAligned,          // handles within tolerance, simulation frozen
  kStartRequested,   // a person (simulated rig: the program) starts
  kStopRequested,    // anybody asks to stop, or the monitor saw something: stop and hold (S2)
  kStopAndPowerOff,  // a stop that must end without power (S1, S0)
  kStandstill,       // both arms at rest
  kReset,            // a person resets; cause absent
  kRecoverRequested, // a person asks to jog away from a limit
  kRecovered,
};
inline constexpr int kRunEvents = 11;

class StateMachine {
 public:
  RunState state() const { return state_; }
  // Goes where the table says; an event that the table does not know leads to STOPPING from any
  // moving state and changes nothing elsewhere. Returns whether the state changed. Never throws.
  bool Handle(RunEvent event) noexcept;
  // States in which velocities other than zero may be sent.
  static bool MayMove(RunState state) noexcept;
  // States in which simulated time passes: RUN only.
  static bool TimePasses(RunState state) noexcept { return state == RunState::kRun; }

 private:
  RunState state_ = RunState::kInit;
  bool power_off_ = false;  // severity of the stop in progress; never falls without reset
};

}  // namespace predictor
