// The emulator: one tick reads the device, moves the virtual world, renders it and keeps it safe.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/record.h"
#include "core/run_input.h"
#include "devices/device.h"
#include "haptics/stability.h"
#include "safety/state_machine.h"
#include "safety/stop.h"
#include "scenario/scenario.h"

namespace predictor {

inline constexpr std::size_t kStateBytes = std::size_t{1} << 18;  // most of a saved state

// A headset that sends no frame for longer has left its wearer blind [s].
inline constexpr double kHeadsetSilence = 0.25;

// An enabling key or button that is silent for longer counts as let go [s].
inline constexpr double kEnablingSilence = 0.1;

// With real arms a run is reset only when its cause has been gone for so long [s], and no more
// presses on a handle than this [N], [N·m].
inline constexpr double kCauseAbsent = 0.5, kFreeForce = 5, kFreeTorque = 1;

// What was found and chosen before the first tick.
struct EmulatorSetup {
  LeadChoice lead;                         // of the reference, with its stability margin
  std::array<JointVector, kHands> start;   // joints at which the handles stand on the virtual ones
  std::string device;                      // the device in words
  bool simulated = true;                   // no real arm moves
  Vector3 object_start = Vector3::Zero();  // O in W [m]
  std::vector<std::string> cobot_joints;   // names
};

class Emulator {
 public:
  // Loads models, finds the world's equilibrium, places the arms. `device`: the real arms, or null
  // for the simulated rig. Throws InputError with what to change.
  explicit Emulator(const Scenario& scenario, std::unique_ptr<Device> device = nullptr);
  ~Emulator();

  // One tick of dt = 1/scenario.rate. `wall_ns`: monotonic clock at its start, 0 in virtual time;
  // `missed`: ticks that the loop missed in a row. No heap, lock, blocking call, exception or
  // logging. The record of the tick is in record() until the next one.
  void Tick(std::uint64_t wall_ns = 0, int missed = 0) noexcept;

  // Takes what a person or a page put in, for the next tick; at most kInputsPerTick between ticks.
  // From the tick's thread. What is out of range, or not this run's to take, is refused: false.
  // With real arms align, start and reset are not taken: those need a person at the rig, who asks
  // by Request, and keeps enabling (kEnable) while the arms may move.
  bool Submit(const RunInput& input) noexcept;
  // Whether the next tick takes one more.
  bool HasRoomForInput() const noexcept;

  // Asks for an event at the next tick; from any thread, without waiting. The record says if it was
  // refused, and why.
  void Request(RunEvent event) noexcept;
  // Brings the arms to rest as a stop does, without a cause; from any thread.
  void RequestEnd() noexcept;

  // The complete state between two ticks: an emulator of the same scenario that loads it goes on
  // to the same bits, given the same inputs and, with a real device, the same samples. Returns the
  // size, at most kStateBytes; 0 if `to` is too small. No heap; from the tick's thread.
  std::size_t SaveState(std::span<std::byte> to) noexcept;
  // Throws InputError if it is not a state of this scenario and version.
  void LoadState(std::span<const std::byte> from);

  const TickRecord& record() const;
  RunState state() const;
  StopLevel level() const;         // of the stop in progress or done
  double run_time() const;         // [s]
  const StopReport& stop() const;  // of the last stop
  const EmulatorSetup& setup() const;
  const Scenario& scenario() const;
  double dt() const;  // [s]

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
