// Provides the simulated rig as a device in virtual time, which advances by one tick per command.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "devices/device.h"
#include "rig/rig.h"

namespace predictor {

class SimulatedDevice final : public Device {
 public:
  // `start` and `person` have the same meaning as in Rig. Throws InputError.
  SimulatedDevice(const Scenario& scenario, const std::array<JointVector, kHands>& start,
                  std::unique_ptr<Operator> person);

  // Returns kDevice and the hand if an arm reports a fault.
  Status Read(DeviceSample* sample) noexcept override;
  // Accepts the command and advances by one tick, 1/scenario.rate.
  Status Write(const DeviceCommand& command) noexcept override;
  void Archive(StateArchive& a) noexcept override { rig_.Archive(a); }
  std::string Describe() const override;

  // Returns the true state, for evaluation only.
  const OperatorOutput* truth() const noexcept override { return &rig_.true_operator(); }
  const Rig& rig() const { return rig_; }

 private:
  double dt_;
  std::string description_;
  Rig rig_;
};

}  // namespace predictor
