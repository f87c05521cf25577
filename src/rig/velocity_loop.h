// One joint in velocity mode: second-order loop, pure delay, limits of speed and acceleration.
#pragma once

#include "core/filters.h"
#include "scenario/scenario.h"

namespace predictor {

// v'' + 2 ζ ω v' + ω² v = ω² u(t − delay), exact for a command that is held between steps: also for
// a delay that is not a whole number of steps, where the command changes within a step.
class VelocityLoop {
 public:
  static constexpr double kMaxDelay = 0.25;  // [s]

  // delay: the loop's own and whatever else comes before it [s]; dt [s], at least 1 ms.
  VelocityLoop(const VelocityLoopSpec& spec, double delay, double dt, double velocity_limit,
               double acceleration_limit);

  // At rest at q [rad], with no command on its way.
  void Reset(double q) noexcept;
  // One step of dt with the command u [rad/s]. Beyond a limit the joint keeps to it: its
  // acceleration runs straight to the limit, its speed stays at the limit.
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
  // (q, v, a) after a step = A (q, v, a) + older · (command before the change) + newer · (after
  // it).
  Matrix3 A_;
  Vector3 older_, newer_;
  double q_ = 0, v_ = 0, a_ = 0, previous_u_ = 0;
  Delay<double, 256> commands_;
};

}  // namespace predictor
