// The simulated hardware: two arms in velocity mode, sensors, handles and a person. The rig knows
// the poses of its handles, but nothing about the simulated task.
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

  // `start` contains the initial joint positions of each arm [rad]. An arm exists if the scenario
  // has a handle for this arm. `person` is nullptr if no person holds the handles. Throws
  // InputError.
  Rig(const Scenario& scenario, const std::array<JointVector, kHands>& start,
      std::unique_ptr<Operator> person);
  ~Rig();

  // Reads what the controllers of the arms and sensors report now. An arm reports a fault if its
  // last command was not finite or had the wrong number of joints. Does not use the heap or a lock,
  // and does not throw.
  void Read(DeviceSample* sample) noexcept;
  // Takes the command and advances by dt [s] in steps of 1 ms (shorter if the tick is shorter). An
  // arm for which the command has no values is commanded to stand still. Does not use the heap or a
  // lock, and does not throw.
  void Step(const DeviceCommand& command, double dt) noexcept;
  // Advances by dt [s] without a command. After kWatchdog, the arms come to rest by themselves.
  void Pass(double dt) noexcept;

  void Archive(StateArchive& a) noexcept;

  // The following functions return the ground truth, for tests and evaluation only. These functions
  // return the handles' motion, the hands' wrench F_H_W (the reading of a perfect sensor at the
  // grip), the grip, and the script's action.
  const std::array<FrameMotion, kHands>& true_handles() const;
  const OperatorOutput& true_operator() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
