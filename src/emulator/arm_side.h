// One arm of the device, as the pipeline uses it: the measured joints, the handle and the hand's
// wrench.
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

  // Computes kinematics and wrench from a sample. Returns kSensor, with a wrench of zero, if the
  // reading cannot be used. Does not use the heap or throw.
  Status Update(const ArmSample& sample) noexcept;

  // Predicts the kinematics at the time when the arm will follow the next command. An arm follows a
  // commanded velocity after a lag, during which the joints continue to move. `last` is the command
  // last sent [rad/s].
  void LookAhead(const JointVector& last) noexcept;
  // Advances the prediction by `time` [s] when the latest joint sample is stale.
  void Extrapolate(const JointVector& last, double time) noexcept;

  // Averages the readings of the unloaded sensor to determine its bias. The hands must be off the
  // handles.
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
  const FrameMotion& handle() const { return handle_motion_; }
  const HandWrench& wrench() const { return wrench_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  Pose X_EH_;
  FrameId end_effector_, handle_;
  RobotData data_, ahead_;
  double lag_;  // lag of the arm's velocity loop [s]
  HandEstimator estimator_;
  MotionDifferentiator differentiator_;
  JointVector q_, q_ahead_;
  FrameMotion end_effector_motion_;
  FrameMotion handle_motion_;
  HandWrench wrench_;
};

}  // namespace predictor
