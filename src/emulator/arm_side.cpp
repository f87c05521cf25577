#include "emulator/arm_side.h"

#include "core/motion.h"
#include "emulator/placement.h"
#include "haptics/stability.h"
#include "scenario/operating_rules.h"

namespace predictor {

ArmSide::ArmSide(const Scenario& s, int i, double dt)
    : model_(LoadArm(s, i)),
      X_EH_(s.arm(i).handle.ToPose()),
      end_effector_(model_->Frame(s.arm(i).end_effector)),
      handle_(model_->Frame(s.arm(i).end_effector, X_EH_)),
      data_(*model_),
      ahead_(*model_),
      lag_(HapticLoop::Lag(s.arm(i).loop, dt)),
      estimator_(s.arm(i).sensor, s.arm(i).payload, X_EH_, RulesFor(s).handle_gravity, dt),
      differentiator_(dt, model_->dof()),
      q_(JointVector::Zero(model_->dof())),
      q_ahead_(q_) {}

Status ArmSide::Update(const ArmSample& sample) noexcept {
  wrench_ = {};
  if (sample.q.size() != model_->dof() || !sample.q.allFinite() || !sample.v.allFinite())
    return {StopCause::kSensor, -1, 0, 0};
  q_ = sample.q;
  data_.UpdateKinematics(*model_, sample.q, sample.v);
  end_effector_motion_ = data_.MotionOf(*model_, end_effector_, differentiator_.Update(sample));
  handle_motion_ = MotionOfFixed(end_effector_motion_, X_EH_);
  return estimator_.Update(sample, end_effector_motion_, &wrench_);
}

void ArmSide::LookAhead(const JointVector& last) noexcept {
  q_ahead_ = q_ + lag_ * last;
  ahead_.UpdateKinematics(*model_, q_ahead_, last);
}

void ArmSide::Extrapolate(const JointVector& last, double time) noexcept {
  q_ahead_ += time * last;
  ahead_.UpdateKinematics(*model_, q_ahead_, last);
}

Status ArmSide::Tare(const ArmSample& sample) noexcept {
  return estimator_.Tare(sample, end_effector_motion_.X_W);
}

void ArmSide::Reset() noexcept {
  estimator_.Reset();
  differentiator_.Reset();
}

}  // namespace predictor
