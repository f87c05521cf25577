// The far end of the wire, simulated: two arms in velocity mode, sensors, handles and a person.
// It knows its handles' poses and nothing of the simulation.
#pragma once

#include <array>
#include <memory>

#include "core/archive.h"
#include "core/messages.h"
#include "rig/operator.h"
#include "scenario/scenario.h"

namespace predictor {

class Rig {
 public:
  static constexpr double kWatchdog =
      0.020;  // an arm without a command for longer comes to rest [s]

  // `start`: joints of each arm at the beginning [rad]; an arm exists where the scenario has a
  // handle. `person`: nullptr for nobody. Throws InputError.
  Rig(const Scenario& scenario, const std::array<JointVector, kHands>& start,
      std::unique_ptr<Operator> person);
  ~Rig();

  // What the controllers of arms and sensors report now. An arm whose last command was not finite,
  // or not one number a joint, reports a fault. No heap, lock or exception.
  void Read(DeviceSample* sample) noexcept;
  // Takes the command and lets dt [s] pass in steps of 1 ms (shorter if the tick is). An arm for
  // which the command holds no number is told to stand still.
  void Step(const DeviceCommand& command, double dt) noexcept;
  // Lets dt [s] pass without a command: after kWatchdog the arms come to rest by themselves.
  void Pass(double dt) noexcept;

  void Archive(StateArchive& a) noexcept;

  // Truth, for tests and evaluation only: handles' motion, the hands' wrench F_H_W (what a perfect
  // sensor at the grip would read), grip, the script's action.
  const std::array<FrameMotion, kHands>& true_handles() const;
  const OperatorOutput& true_operator() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
