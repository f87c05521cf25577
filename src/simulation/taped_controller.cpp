#include "simulation/taped_controller.h"

#include <predictor/controller.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace predictor {

TapedController::TapedController(std::unique_ptr<Controller> controller, int dof)
    : controller_(std::move(controller)),
      tape_{controller_->uses_wrist_sensor() ? 1.0 : 0.0,
            static_cast<double>(controller_->memory().size()), static_cast<double>(dof)} {}

TapedController::TapedController(std::vector<double> tape, int dof) : tape_(std::move(tape)) {
  if (tape_.size() < next_ || !(tape_[1] >= 0) || !(tape_[1] <= double{PREDICTOR_MAX_MEMORY}) ||
      tape_[2] != dof)
    throw InputError::At("cobot.controller",
                         "cobot.controller is a program that the recording does not contain, and "
                         "its recorded answers are missing or do not fit. Use the unchanged "
                         "recording, with the version of PREDICTOR that wrote it.");
  memory_.resize(static_cast<std::size_t>(tape_[1]));
  answer_.torque.setZero(dof);
}

void TapedController::SetUp(bool begins) noexcept {
  sets_up_ = begins;
  if (controller_) controller_->SetUp(begins);
}

void TapedController::Tape(std::span<double> answer) const noexcept {
  if (!sets_up_) return;
  if (controller_) {
    tape_.insert(tape_.end(), answer.begin(), answer.end());
    return;
  }
  if (tape_.size() - next_ < answer.size()) {
    std::ranges::fill(answer, std::nan(""));
    return;
  }
  std::copy_n(tape_.begin() + static_cast<std::ptrdiff_t>(next_), answer.size(), answer.begin());
  next_ += answer.size();
}

void TapedController::Compute(const ControllerInput& input, JointVector* torque) noexcept {
  if (controller_)
    controller_->Compute(input, torque);
  else
    *torque = answer_.torque;
  Tape({torque->data(), static_cast<std::size_t>(torque->size())});
}

ControllerOutcome TapedController::outcome() const noexcept {
  if (controller_) return controller_->outcome();
  return sets_up_ ? ControllerOutcome::kComputed : answer_.outcome;
}

Status TapedController::failure() const noexcept {
  return controller_ ? controller_->failure() : answer_.failure;
}

void TapedController::SetRealTime(bool real_time) noexcept {
  if (controller_) controller_->SetRealTime(real_time);
}

std::span<double> TapedController::memory() noexcept {
  return controller_ ? controller_->memory() : memory_;
}

void TapedController::Start(const ControllerInput& input) noexcept {
  if (controller_) controller_->Start(input);
  Tape(memory());
}

void TapedController::Advance(const ControllerInput& input, double dt) noexcept {
  if (controller_) controller_->Advance(input, dt);
  Tape(memory());
}

double TapedController::StoredEnergy(const ControllerInput& input) const noexcept {
  double energy = controller_ ? controller_->StoredEnergy(input) : 0;
  Tape({&energy, 1});
  return energy;
}

}  // namespace predictor
