// Models one joint in velocity mode: a second-order loop with a pure delay and limits of speed and
// acceleration.
#pragma once

#include "core/filters.h"
#include "scenario/scenario.h"

namespace predictor {

// v'' + 2 ζ ω v' + ω² v = ω² u(t − delay), integrated exactly for a command that is constant
// between steps. The delay need not be a whole number of steps, because the command may change
// within a step.
class VelocityLoop {
 public:
  static constexpr double kMaxDelay = 0.25;  // [s]

  // `delay` is the sum of the loop's own delay and of any delay before the loop [s]. `dt` is in [s]
  // and at least 1 ms.
  VelocityLoop(const VelocityLoopSpec& spec, double delay, double dt, double velocity_limit,
               double acceleration_limit);

  // Resets the joint to rest at q [rad], without commands in the delay.
  void Reset(double q) noexcept;
  // Advances by dt with the command u [rad/s]. If a limit is reached, the acceleration ramps
  // linearly to its limit, and the speed stays at its limit.
  void Step(double u) noexcept;

  template <class A>
  void Archive(A& a) {
    a(q_, v_, a_, previous_u_, commands_);
  }

  double q() const { return q_; }  // [rad]
  double v() const { return v_; }  // [rad/s]
  double a() const { return a_; }  // [rad/s²]

 private:
  double dt_, velocity_limit_, acceleration_limit_;
  double delay_samples_;
  // After a step, (q, v, a) is A (q, v, a) + older · (command before the change) + newer · (command
  // after the change).
  Matrix3 A_;
  Vector3 older_, newer_;
  double q_ = 0, v_ = 0, a_ = 0, previous_u_ = 0;
  Delay<double, 256> commands_;
};

}  // namespace predictor
