// A haptic device: one or two arms in velocity mode, each with a force/torque sensor.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// Of an enabling device: a contact that a person holds pressed while the arms may move.
enum class Enabling : std::uint8_t {
  kNone,      // the device has no such input
  kSilent,    // nobody knows: what tells of it is old
  kReleased,  //
  kPressed,   //
};

class Device {
 public:
  virtual ~Device() = default;

  // Newest sample of each arm and sensor. Never blocks, allocates or throws. kDevice on a fault.
  virtual Status Read(DeviceSample* sample) noexcept = 0;

  // Sends joint velocities. Never blocks, allocates or throws. What is not sent within the
  // device's own time-out stops the arms by itself.
  virtual Status Write(const DeviceCommand& command) noexcept = 0;

  // Its enabling device, as of the last Read. No heap, no exception.
  virtual Enabling enabling() const noexcept { return Enabling::kNone; }

  // A simulated one's state; a real one has none that could be put back.
  virtual void Archive(StateArchive&) noexcept {}

  // One line for a person: what it is, rates, versions.
  virtual std::string Describe() const = 0;
};

// The simulated rig of a scenario. Throws InputError: the scenario is for real arms, or what the
// rig needs. `start`: the joints at which its arms are parked (absent sides empty).
std::unique_ptr<Device> MakeSimulatedDevice(const Scenario& scenario,
                                            const std::array<JointVector, kHands>& start);

}  // namespace predictor
