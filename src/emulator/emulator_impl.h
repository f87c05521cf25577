// What an emulator holds between ticks, and the steps of a tick. For this folder alone.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>

#include "devices/simulated/simulated_device.h"
#include "emulator/arm_side.h"
#include "emulator/emulator.h"
#include "emulator/parameter_ramps.h"
#include "emulator/stage_timer.h"
#include "haptics/recovery.h"
#include "haptics/renderer.h"
#include "rig/operator.h"
#include "safety/guard.h"
#include "safety/monitor.h"
#include "safety/warnings.h"
#include "simulation/world.h"

namespace predictor {

// Of a handle [m/s], [rad/s].
struct HandleCap {
  double speed, rotation;
};

struct Emulator::Impl {
  Impl(const Scenario& scenario, std::unique_ptr<Device> real_arms);

  void Tick(std::uint64_t wall_ns, int deadlines_missed) noexcept;
  bool Submit(const RunInput& input) noexcept;
  bool Take(const RunInput& input) noexcept;
  bool TakeHand(const RunInput& input) noexcept;
  void FollowParameters() noexcept;
  void TakeRequests() noexcept;
  void StopOnRequest(RunEvent stop) noexcept;
  void Obey(RunEvent event) noexcept;
  Refusal WhyNot(RunEvent event) const noexcept;
  bool HandsFree() const noexcept;
  bool ArmsStand() const noexcept;
  bool Enabled() const noexcept { return setup.simulated || enabling_age <= kEnablingSilence; }
  Status CheckEnabling() const noexcept;
  void FollowEnablingDevice() noexcept;
  std::array<RenderArm, kHands> View() const noexcept;
  void Recover() noexcept;
  void Sense(Status* status) noexcept;
  void Simulate(Status* status) noexcept;
  void ActDirectly() noexcept;
  bool Renders() const noexcept {
    return !direct && (states.state() == RunState::kRun || states.state() == RunState::kAlign);
  }
  void Render(Status* status) noexcept;
  void Judge(const Status& wrong, RunEvent stop = RunEvent::kStopRequested) noexcept;
  void Escalate(const Status& why, RunEvent stop) noexcept;
  Status Restless() const noexcept;
  int TicksPassed() const noexcept;
  void Brake() noexcept;
  void Command() noexcept;
  HandleCap Cap() const noexcept;
  int KeepToCap(const std::array<Jacobian, kHands>& J) noexcept;
  Status Doubt() noexcept;
  void Write() noexcept;
  void Advance() noexcept;
  bool Within(double position, double rotation) const noexcept;
  bool Aligned() const noexcept;
  bool InMotion() const noexcept;
  bool Waits() const noexcept;
  bool Recovered() const noexcept;
  void Warn() noexcept;
  void BeginStop(const Status& cause, RunEvent stop) noexcept;
  void BeginTare() noexcept;
  void ResetRun() noexcept;
  void Record(std::uint64_t wall_ns) noexcept;
  void RecordHand(std::size_t i, const OperatorOutput* truth) noexcept;
  void RecordRendering() noexcept;
  void Archive(StateArchive& a) noexcept;

  const Scenario scenario;
  const double dt;  // [s]
  const bool direct;
  std::array<bool, kHands> present = {};
  World world;
  std::array<std::optional<ArmSide>, kHands> arms;
  std::unique_ptr<Device> device;        // null in direct mode
  const SimulatedDevice* rig = nullptr;  // the same, if it is simulated: its truth is recorded
  std::unique_ptr<Operator> person;      // direct mode: the hands on the object's own handles
  EmulatorSetup setup;
  std::optional<Renderer> renderer;
  std::optional<Recovery> recovery;
  Monitor monitor;
  Warnings warnings;
  Guard guard;
  StateMachine states;
  StopController stopper;

  ParameterRamps parameters;
  std::array<HandInput, kHands> hand_inputs;
  std::array<RunInput, kInputsPerTick> inputs;  // taken since the last tick
  int input_count = 0;

  // Working memory of the tick.
  DeviceSample sample;
  DeviceCommand command;
  OperatorOutput hands;  // of a simulated person, at the time of the sample
  RenderResult rendered;
  bool ran = false;      // simulated time passed in this tick
  bool waiting = false;  // for an arm that cannot move yet
  bool solved = false;   // `rendered` is of this tick
  WorldState before;     // the virtual world at the time of the sample
  std::array<FrameMotion, kHands> real;
  std::array<HandWrench, kHands> wrench;
  std::array<JointVector, kHands> lower, upper, fastest;  // of the joints [rad], [rad/s]
  Status sensing, simulation, haptics, reading, writing;
  std::uint16_t asked = 0;        // the requests that this tick took, as recorded
  std::uint32_t missed = 0;       // deadlines, as the loop said
  Status headset = Status::Ok();  // of one that fell silent, as told before this tick
  Status latched;
  Status harder;              // what took the power off at the end of a stop that would have held
  double enabling_age = 1e9;  // since the enabling key was known to be held [s]
  bool pressed = false;       // the enabling device counts as pressed
  bool was_released = false;  // it was, since the program began or the last stop did
  double pressed_time = 0;    // since that was put in as an input [s]
  double well_time = 0;       // since anything was wrong [s]
  bool aligned = false;   // the handles are where they belong: nothing but rest is told in ALIGN
  bool doubtful = false;  // what the joints are said to be, in this stop
  bool tared = false;     // the sensors' biases are known
  // Of the handles, by the last command [m/s], [rad/s].
  std::array<Twist, kHands> handle_twist = {Twist::Zero(), Twist::Zero()};
  double handle_speed = 0, handle_rate = 0;  // of the commanded motion of the faster handle
  double run_time = 0;                       // [s]
  double state_time = 0;                     // since the state was entered [s]
  StageTimer timer;
  TickRecord record{};
  std::atomic<std::uint32_t> requests{0};  // bit = RunEvent
  std::atomic<bool> end_requested{false};
};

}  // namespace predictor
