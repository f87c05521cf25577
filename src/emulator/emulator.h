// In each tick, the emulator reads the device, moves the virtual world, renders this world with the
// arms, and checks the safety limits.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/record.h"
#include "core/run_input.h"
#include "devices/device.h"
#include "emulator/run_limits.h"
#include "haptics/stability.h"
#include "safety/state_machine.h"
#include "safety/stop.h"
#include "scenario/operating_rules.h"
#include "scenario/scenario.h"

namespace predictor {

inline constexpr std::size_t kStateBytes = std::size_t{1} << 18;  // largest size of a saved state

// Facts that are known, and choices that are made, before the first tick.
struct EmulatorSetup {
  LeadChoice lead;                        // lead of the reference, with its stability margin
  std::array<JointVector, kHands> start;  // joint positions at which the real handles coincide with
                                          // the virtual ones
  std::string device;                     // one line of text for the user
  OperatingRules rules;                   // rules of the scenario
  Vector3 object_start = Vector3::Zero();  // O in W [m]
  std::vector<std::string> cobot_joints;   // joint names
  std::vector<double> controller_tape;     // World::ControllerTape, for the recording
};

class Emulator {
 public:
  // Loads the models, finds the world's equilibrium, and places the arms. `device` contains the
  // real arms, or is null for the simulated rig. Throws InputError, which states the remedy.
  explicit Emulator(const Scenario& scenario, std::unique_ptr<Device> device = nullptr);
  ~Emulator();

  // Executes one tick of dt = 1/scenario.rate. `wall_ns` is the monotonic clock at the start of the
  // tick, or 0 in virtual time. `missed` is the number of consecutive deadlines that the loop
  // missed. The function does not use the heap, locks or blocking calls, and does not throw or log.
  // Until the next tick, record() returns the record of this tick.
  void Tick(std::uint64_t wall_ns = 0, int missed = 0) noexcept;

  // For a replay, this function sets the answer of a controller outside the program in the next
  // tick.
  void Play(const TickRecord& record) noexcept;

  // If the scenario requests it, gives the process of the cobot's controller a real-time priority
  // or removes this priority again (Controller::PrioritiseProcess). Returns a text that states what
  // the system granted.
  std::string PrioritiseController(bool on);

  // Accepts an input for the next tick. At most kInputsPerTick inputs are accepted between two
  // ticks. Only the tick's thread may call this. Returns false if the input is out of range or the
  // operating rules refuse it. With real arms, inputs that request alignment, start or reset are
  // refused. Instead, a person at the rig makes these requests through Request, and must enable
  // motion (kEnable) as long as the arms may move.
  bool Submit(const RunInput& input) noexcept;
  // Returns whether the next tick accepts another input.
  bool HasRoomForInput() const noexcept;

  // Requests an event for the next tick. Any thread may call this function, which does not wait.
  // The record shows whether the request was refused, and why.
  void Request(RunEvent event) noexcept;
  // Brings the arms to rest in the same way as a stop, but without a fault. May be called from any
  // thread.
  void RequestEnd() noexcept;

  // Saves the complete state. Call this function between two ticks. An emulator of the same
  // scenario that loads this state continues identically, bit for bit. This requires that it
  // receives the same inputs and, with a real device, the same samples. Returns the size of the
  // saved state, which is at most kStateBytes, or 0 if `to` is too small. Does not use the heap.
  // Only the tick's thread may call this.
  std::size_t SaveState(std::span<std::byte> to) noexcept;
  // Throws InputError if the bytes are not a state of this scenario and version. With a `seed`, the
  // emulator continues from the same state with other random numbers, which depend on this seed:
  // the noise, tremor and pace of the operator, the noise of the sensors, and the times of events
  // that have not begun. Equal seeds give bit-identical runs.
  void LoadState(std::span<const std::byte> from, std::optional<std::uint64_t> seed = std::nullopt);

  const TickRecord& record() const;
  RunState state() const;
  StopLevel level() const;         // level of the current or last stop
  double run_time() const;         // [s]
  const StopReport& stop() const;  // report of the last stop
  // Describes why ALIGN was refused in the last tick. The text names the two parts that are too
  // close to each other, the key in the scenario's file, and the remedy. Returns "" if ALIGN was
  // not refused. It must not be called in a tick.
  std::string WhyNotAligned() const;
  // Returns a sentence that states why the physics engine has stopped computing, or "" if the
  // engine works.
  std::string EngineFailure() const;
  const EmulatorSetup& setup() const;
  const Scenario& scenario() const;
  double dt() const;  // [s]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
