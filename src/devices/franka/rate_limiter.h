// Limits the commands to a Franka arm's joints so that the arm's own reflexes accept them.
#pragma once

#include "devices/franka/fci.h"

namespace predictor::fci {

struct JointLimit {
  double lower, upper;  // [rad]
  double velocity;      // [rad/s]
  double acceleration;  // [rad/s²]
  double jerk;          // [rad/s³]
  // At distance d from the end of its range, a joint may move towards this end at sqrt(2 ·
  // deceleration · d) − offset.
  double deceleration;  // [rad/s²]
  double offset;        // [rad/s]
};
using JointLimits = std::array<JointLimit, kJoints>;

// Returns the limits published in Franka's "Robot and interface specifications" (frankaemika/docs,
// control_parameters.rst) and in rate_limiting.h of libfranka 0.9.2 and 0.21.2. For the Research 3,
// these are the limits for system versions before 5.9, which are stricter than the later limits. A
// Panda's velocity limits do not depend on the position. The driver nevertheless brakes before the
// ends of these ranges.
const JointLimits& PublishedLimits(std::uint16_t version);

// Computes the velocities for the next millisecond. They are as close to the request as the limits
// of velocity, acceleration, jerk and range allow. The velocities are computed from the robot's
// state over the nominal millisecond. As in the robot, derivatives are backward differences: a = (v
// − v_last) / dt.
//
// A robot that misses commands continues at constant acceleration for up to 20 cycles. The limiter
// therefore always keeps a sufficient distance from the velocity limit, so that there is enough
// time to reduce the acceleration to zero.
class RateLimiter {
 public:
  static constexpr double kDt = 0.001;  // robot cycle [s]
  // time for which the robot continues without commands [s]
  static constexpr double kCoasting = 0.020;

  // `fraction` is the share of the limits that the limiter uses. The share is above 0 and at most
  // 0.99, because sums are rounded. Throws std::invalid_argument.
  RateLimiter(const JointLimits& limits, double fraction);

  // Starts with a robot that moves with velocity v and acceleration a.
  void Start(const Joints& v, const Joints& a) noexcept;
  // Returns the next command. `asked` is in [rad/s]. A value that is not finite counts as zero. `q`
  // is the commanded position [rad]. `missed` states whether states or commands were lost recently.
  // In this case, the limiter does not accelerate the robot, because the robot may have to coast
  // again.
  const Joints& Next(const Joints& asked, const Joints& q, bool missed) noexcept;
  const Joints& v() const noexcept { return v_; }
  const Joints& a() const noexcept { return a_; }
  bool AtRest() const noexcept;

 private:
  JointLimits limits_;  // the limits in use
  Joints v_{}, a_{};
};

// Brings a robot that has deviated because of lost commands or states back to the request. The
// limits of the joints alone would allow a sudden return, in which the handle would jerk.
class WayBack {
 public:
  static constexpr double kTime = 0.020;  // duration of the return [s]

  // The difference between robot and request consists of a velocity and an acceleration.
  void Begin(const Joints& v, const Joints& a) noexcept;
  // Returns the permitted difference from the request in the next millisecond [rad/s], or zero
  // after the return.
  Joints Next() noexcept;
  bool active() const noexcept { return time_ < kTime; }

 private:
  Joints v_{}, a_{};
  double time_ = kTime;  // time since the return began [s]
};

}  // namespace predictor::fci
