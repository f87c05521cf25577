// One real arm as the emulator follows it: measured joints, handle, and the hand's wrench.
#pragma once

#include <memory>

#include "core/messages.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "sensing/hand_estimator.h"
#include "sensing/motion_differentiator.h"

namespace predictor {

class ArmSide {
 public:
  // Loads the arm of hand `i`. Throws InputError.
  ArmSide(const Scenario& scenario, int i, double dt);

  // Kinematics and wrench out of a sample. kSensor when the reading cannot be used; the wrench is
  // zero then. No heap, no throw.
  Status Update(const ArmSample& sample) noexcept;

  // Kinematics where the arm will be when it obeys the next command: a velocity is obeyed a lag
  // later, and by then the joints have moved on. `last`: command last sent [rad/s].
  void LookAhead(const JointVector& last) noexcept;
  // The same from where that was, time [s] later, when what the joints are said to be is old.
  void GoOn(const JointVector& last, double time) noexcept;

  // Averages the unloaded sensor into its bias; hands off.
  Status Tare(const ArmSample& sample) noexcept;
  void BeginTare() noexcept { estimator_.BeginTare(); }
  Status FinishTare() noexcept { return estimator_.FinishTare(); }
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept {
    a(estimator_, differentiator_, q_, q_ahead_, end_effector_motion_, handle_motion_, wrench_);
  }

  const std::shared_ptr<const RobotModel>& model() const { return model_; }
  const RobotData& data() const { return data_; }
  const RobotData& ahead() const { return ahead_; }
  FrameId handle_frame() const { return handle_; }
  const JointVector& q() const { return q_; }
  const FrameMotion& handle() const { return handle_motion_; }  // X_WH, V_WH
  const HandWrench& wrench() const { return wrench_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  FrameId end_effector_, handle_;
  RobotData data_, ahead_;
  double lag_;  // of the arm's velocity loop [s]
  HandEstimator estimator_;
  MotionDifferentiator differentiator_;
  JointVector q_, q_ahead_;
  Jacobian J_;  // of E
  FrameMotion end_effector_motion_;
  FrameMotion handle_motion_;
  HandWrench wrench_;
};

}  // namespace predictor
