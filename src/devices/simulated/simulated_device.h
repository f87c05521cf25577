// The simulated rig as a device: virtual time, one tick a command.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "devices/device.h"
#include "rig/rig.h"

namespace predictor {

class SimulatedDevice final : public Device {
 public:
  // `start`, `person`: as for Rig. Throws InputError.
  SimulatedDevice(const Scenario& scenario, const std::array<JointVector, kHands>& start,
                  std::unique_ptr<Operator> person);

  // kDevice, with the hand, if an arm reports a fault.
  Status Read(DeviceSample* sample) noexcept override;
  // Takes the command and lets one tick, 1/scenario.rate, pass.
  Status Write(const DeviceCommand& command) noexcept override;
  void Archive(StateArchive& a) noexcept override { rig_.Archive(a); }
  std::string Describe() const override;

  // The truth, for evaluation only.
  const Rig& rig() const { return rig_; }

 private:
  double dt_;
  std::string description_;
  Rig rig_;
};

}  // namespace predictor
