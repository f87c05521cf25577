// The far end of the wire, simulated: two arms in velocity mode, sensors, handles and a person.
// It knows its handles' poses and nothing of the simulation.
#pragma once

#include <array>
#include <memory>

#include "core/messages.h"
#include "rig/operator.h"
#include "scenario/scenario.h"

namespace predictor {

class Rig {
 public:
  // `start`: joints of each arm at the beginning [rad]. Throws InputError.
  Rig(const Scenario& scenario, const std::array<JointVector, kHands>& start,
      std::unique_ptr<Operator> person);
  ~Rig();

  // What the controllers of arms and sensors report now. No heap, lock or exception.
  void Read(DeviceSample* sample) noexcept;
  // Takes the command and lets dt [s] pass in steps of 1 ms.
  void Step(const DeviceCommand& command, double dt) noexcept;

  // Truth, for tests and evaluation only: handles' motion, the hands' wrench F_H_W (what a perfect
  // sensor at the grip would read), grip, the script's action.
  const std::array<FrameMotion, kHands>& true_handles() const;
  const OperatorOutput& true_operator() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
