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

struct OperatorOutput;  // rig/operator.h

// State of an enabling device: a contact that a person holds closed while the arms may move.
enum class Enabling : std::uint8_t {
  kNone,      // the device has no such input
  kSilent,    // unknown: the last report is too old
  kReleased,  //
  kPressed,   //
};

class Device {
 public:
  virtual ~Device() = default;

  // Reads the newest sample of each arm and sensor. Returns kDevice on a fault. Never blocks,
  // allocates or throws.
  virtual Status Read(DeviceSample* sample) noexcept = 0;

  // Sends joint velocities. Never blocks, allocates or throws. If no command arrives within the
  // device's own time-out, the arms stop by themselves.
  virtual Status Write(const DeviceCommand& command) noexcept = 0;

  // Returns the state that the enabling device had at the last Read. Does not use the heap or
  // throw.
  virtual Enabling enabling() const noexcept { return Enabling::kNone; }

  // Returns the current state of the simulated operator, for the record, or null if a person holds
  // the handles.
  virtual const OperatorOutput* truth() const noexcept { return nullptr; }

  // Saves or loads the state of a simulated device. The state of a real device cannot be restored.
  virtual void Archive(StateArchive&) noexcept {}

  // Returns one line for the user, with the name, the rates and the versions of the device.
  virtual std::string Describe() const = 0;
};

// Makes the simulated rig of a scenario. Throws InputError if the scenario is for real arms or
// lacks data for the rig. `start` contains the joint positions at which the arms are parked (empty
// for absent sides).
std::unique_ptr<Device> MakeSimulatedDevice(const Scenario& scenario,
                                            const std::array<JointVector, kHands>& start);

}  // namespace predictor
