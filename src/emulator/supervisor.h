// Makes the decisions of a tick: which requests are granted, which faults stop the arms, and which
// state is next. The supervisor knows neither models nor physics, and judges only the values of the
// tick.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "core/run_input.h"
#include "devices/device.h"
#include "emulator/parameter_ramps.h"
#include "emulator/run_limits.h"
#include "emulator/saved_state.h"
#include "emulator/tick_data.h"
#include "haptics/recovery.h"
#include "safety/monitor.h"
#include "safety/state_machine.h"
#include "safety/stop.h"
#include "safety/warnings.h"
#include "scenario/operating_rules.h"
#include "scenario/scenario.h"

namespace predictor {

// Properties of the arms that are known before the first tick. Absent arms: empty, zero.
struct ArmsSpec {
  std::array<JointBounds, kHands> bounds;
  std::array<double, kHands> lags = {};      // lag behind the commands [s]
  std::array<double, kHands> overruns = {};  // distance travelled after the command reaches zero,
                                             // divided by the speed before [s]
};

// The request that was refused in this tick, in the form used in the record.
struct RefusedRequest {
  std::uint8_t event = 0;  // 1 + RunEvent; 0: none
  Refusal why = Refusal::kNone;
};

class Supervisor {
 public:
  Supervisor(const Scenario& scenario, const ArmsSpec& arms);

  // -- Between ticks, as in Emulator --
  bool Submit(const RunInput& input) noexcept;  // only from the tick's thread
  bool HasRoomForInput() const noexcept { return input_count_ < kInputsPerTick; }
  void Request(RunEvent event) noexcept;  // from any thread
  void RequestEnd() noexcept;             // from any thread

  // -- Steps of a tick, in this order. They do not use the heap or a lock, and do not throw. --

  RunRequests TakeRequests() noexcept;
  // Grants or refuses the requests. `data` contains the values of the previous tick. If ALIGN is
  // requested, `beyond` is the condition that prevents the arms from starting. Returns true if the
  // run was reset. In this case, the pipeline must also be reset.
  bool HandleRequests(const TickData& data, Beyond beyond) noexcept;
  // Returns the work that the pipeline must do in this tick.
  TickPlan Plan(const DeviceSample& sample) noexcept;
  // Runs the safety monitor, checks whether motion is enabled, and updates the warnings. A fault
  // starts a stop.
  void Check(const TickPlan& plan, const TickData& data) noexcept;
  // Returns the motion of the arms in this tick.
  MotionOrder Order(const TickPlan& plan, const TickData& data) const noexcept;
  // Computes the next command of a stop.
  void Brake(const MotionOrder& order, const StopGeometry& geometry,
             std::array<JointVector, kHands>* v) noexcept;
  void ObserveStop(const TickData& data) noexcept;
  // Stops the arms because of a fault, or raises the level of a stop in progress. Does nothing if
  // `fault` is ok.
  void HandleFault(const Status& fault, const SentMotion& sent) noexcept;
  // Advances the time.
  void EndTick(const TickPlan& plan) noexcept;
  // Returns whether the self-test ends in this tick. In this case, the pipeline must finish taring.
  bool SelfTestEnds() const noexcept;
  // Makes the transitions between states that do not need a person. In RECOVERY, `beyond` is the
  // condition that prevents the arms from starting. When the self-test ends, `self_test` is the
  // result of taring. Returns true if the self-test begins. In this case, the pipeline must start
  // taring.
  bool Advance(const TickData& data, Beyond beyond,
               const std::optional<Status>& self_test) noexcept;
  void FollowEnablingDevice(Enabling now) noexcept;

  RunState state() const noexcept { return states_.state(); }
  StopLevel level() const noexcept { return states_.level(); }
  double run_time() const noexcept { return run_time_; }                       // [s]
  const Status& fault() const noexcept { return fault_; }                      // latched
  const Status& power_off_cause() const noexcept { return power_off_cause_; }  // latched
  const RefusedRequest& refused() const noexcept { return refused_; }
  const StopReport& stop() const noexcept { return stopper_.report(); }  // report of the last stop
  const Warnings& warnings() const noexcept { return warnings_; }
  const ParameterRamps& parameters() const noexcept { return parameters_; }
  const std::array<HandInput, kHands>& hand_inputs() const noexcept { return hand_inputs_; }
  const std::array<RunInput, kInputsPerTick>& inputs() const noexcept { return inputs_; }
  int input_count() const noexcept { return input_count_; }

 private:
  friend void ArchiveState(StateArchive& a, const SavedState& state) noexcept;

  // supervisor_requests.cpp
  bool Accept(const RunInput& input) noexcept;
  bool ReportFault(const Status& fault) noexcept;
  bool AcceptHand(const RunInput& input) noexcept;
  void StopOnRequest(RunEvent stop, const SentMotion& sent) noexcept;
  bool Grant(RunEvent event, const TickData& data, Beyond beyond) noexcept;
  Refusal WhyRefused(RunEvent event, const TickData& data, Beyond beyond) const noexcept;
  bool HandsFree(const TickData& data) const noexcept;
  bool ArmsStand(const TickData& data) const noexcept;
  bool Enabled() const noexcept {
    return !rules_.needs_enabling || enabling_age_ <= kEnablingSilence;
  }
  Status CheckEnabling() const noexcept;
  void ResetRun() noexcept;

  // supervisor.cpp
  Status RunMonitor(const TickPlan& plan, const TickData& data) noexcept;
  void UpdateWarnings(const TickData& data) noexcept;
  void HandleFault(const Status& fault, RunEvent stop, const SentMotion& sent) noexcept;
  void EscalateToPowerOff(const Status& fault) noexcept;
  void BeginStop(const Status& cause, RunEvent stop, const SentMotion& sent) noexcept;
  Status StillMoving(const TickData& data) const noexcept;
  int TicksPassed(const TickData& data) const noexcept;
  HandleCap Cap() const noexcept;
  bool Within(double position, double rotation, const TickData& data) const noexcept;
  bool Aligned(const TickData& data) const noexcept;
  bool Recovered(const TickData& data, Beyond beyond) const noexcept;

  const OperatingRules rules_;
  const SafetySpec safety_;
  const double dt_;  // [s]
  const bool direct_, browser_operator_;
  Hands hands_;
  std::array<JointBounds, kHands> bounds_;

  Monitor monitor_;
  Warnings warnings_;
  StateMachine states_;
  StopController stopper_;
  ParameterRamps parameters_;
  std::array<HandInput, kHands> hand_inputs_;

  std::atomic<std::uint32_t> requests_{0};  // bit = RunEvent
  std::atomic<bool> end_requested_{false};
  std::array<RunInput, kInputsPerTick> inputs_;  // accepted since the last tick
  int input_count_ = 0;
  RefusedRequest refused_;

  Status reported_;             // first fault reported by an input before this tick
  Status fault_;                // fault that stopped the run; latched until reset
  Status power_off_cause_;      // fault that raised a stop from hold to power-off; latched
  double healthy_time_ = 0;     // time since the monitor last found a fault [s]
  bool joints_jumped_ = false;  // during this stop: the measured joints cannot be trusted
  bool aligned_ = false;        // ALIGN: the handles are in place while the arms come to rest
  bool tared_ = false;          // the sensors' biases are known
  double run_time_ = 0;         // [s]
  double state_time_ = 0;       // time since the state was entered [s]

  double enabling_age_ = 1e9;         // time since the enabling key or device was last held [s]
  bool device_pressed_ = false;       // the enabling device counts as pressed
  bool device_was_released_ = false;  // since the program started or the last stop began
  double device_time_ = 0;            // time since its last sign was submitted [s]
};

}  // namespace predictor
