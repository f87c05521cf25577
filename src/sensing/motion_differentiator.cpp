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

}  // namespace predictor
