#include "sensing/motion_differentiator.h"

namespace predictor {

const JointVector& MotionDifferentiator::Update(const ArmSample& sample) noexcept {
  if (!started_ || sample.v.size() != v_.size()) {
    a_ = JointVector::Zero(sample.v.size());
  } else {
    ++ticks_;
    if (sample.arm_sequence == sequence_) return a_;
    a_ = (sample.v - v_) / (ticks_ * dt_);
  }
  v_ = sample.v;
  sequence_ = sample.arm_sequence;
  ticks_ = 0;
  started_ = true;
  return a_;
}

void MotionDifferentiator::Reset() noexcept {
  started_ = false;
  ticks_ = 0;
}

FrameMotion MeasuredMotion(const RobotModel& model, const RobotData& data, const FrameId& frame,
                           const Jacobian& J, const JointVector& a) noexcept {
  FrameMotion motion;
  motion.X_W = data.FramePose(model, frame);
  motion.V_W = data.FrameTwist(model, frame);
  motion.A_W = data.FrameBiasAcceleration(model, frame);
  motion.A_W.noalias() += J * a;
  return motion;
}

}  // namespace predictor
