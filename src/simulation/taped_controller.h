// Stores the answers of a controller outside the program, for a replay without this controller.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "simulation/controller.h"

namespace predictor {

// A controller outside the program together with its tape, or the tape alone.
//
// While a scene is set up (the search for the start, the linearisation), every answer goes to the
// tape in order. A replay makes the same calls. During a run, the record of a tick contains the
// controller's answer.
class TapedController final : public Controller {
 public:
  explicit TapedController(std::unique_ptr<Controller> controller, int dof);
  // Makes a controller that replays recorded answers. Throws InputError if the tape does not fit a
  // cobot with dof joints.
  TapedController(std::vector<double> tape, int dof);

  TapedController* taped() noexcept override { return this; }
  void SetUp(bool begins) noexcept override;
  std::span<const double> tape() const noexcept { return tape_; }
  // Sets the answer of the next tick. This function is for replays only.
  void Play(const ControllerAnswer& answer) noexcept { answer_ = answer; }
  // Returns the answer of this tick. The result is null in a run and while the scene is set up.
  const ControllerAnswer* played() const noexcept {
    return controller_ || sets_up_ ? nullptr : &answer_;
  }

  void Compute(const ControllerInput& input, JointVector* torque) noexcept override;
  ControllerOutcome outcome() const noexcept override;
  Status failure() const noexcept override;
  void SetRealTime(bool real_time) noexcept override;
  std::string PrioritiseProcess(bool on) override {
    return controller_ ? controller_->PrioritiseProcess(on) : "";
  }
  std::span<double> memory() noexcept override;
  void Start(const ControllerInput& input) noexcept override;
  void Advance(const ControllerInput& input, double dt) noexcept override;
  bool uses_wrist_sensor() const noexcept override { return tape_[0] != 0; }
  double StoredEnergy(const ControllerInput& input) const noexcept override;

 private:
  // Appends the answer to the tape or, in a replay, takes it from the tape.
  void Tape(std::span<double> answer) const noexcept;

  std::unique_ptr<Controller> controller_;  // null in a replay
  bool sets_up_ = true;
  // The tape contains whether the controller uses the wrist sensor. It also contains the size of
  // the controller's memory, the number of joints, and the answers.
  mutable std::vector<double> tape_;
  mutable std::size_t next_ = 3;
  std::vector<double> memory_;  // of a replay
  ControllerAnswer answer_;
};

}  // namespace predictor
