// What a Franka arm's joints may be told, so that its own reflexes accept it.
#pragma once

#include "devices/franka/fci.h"

namespace predictor::fci {

struct JointLimit {
  double lower, upper;  // [rad]
  double velocity;      // [rad/s]
  double acceleration;  // [rad/s²]
  double jerk;          // [rad/s³]
  // Towards an end of its range that is d away it may go at sqrt(2 · deceleration · d) − offset.
  double deceleration;  // [rad/s²]
  double offset;        // [rad/s]
};
using JointLimits = std::array<JointLimit, kJoints>;

// As published: Franka's "Robot and interface specifications" (frankaemika/docs,
// control_parameters.rst), and rate_limiting.h of libfranka 0.9.2 and 0.21.2. Those of Research 3
// are for systems before 5.9, which are the stricter ones. A Panda's velocities do not depend on
// the position; here it brakes before its ends all the same.
const JointLimits& PublishedLimits(std::uint16_t version);

// Velocities for the next millisecond: as near to what is asked as limits of velocity,
// acceleration, jerk and range allow, reckoned from what the robot has, over the nominal
// millisecond. As the robot does, differences are taken backwards: a = (v − v_last) / dt.
//
// A robot that misses commands goes on at constant acceleration, for up to 20 of them: there is
// always as much left to the velocity limit, and to change the acceleration back to zero.
class RateLimiter {
 public:
  static constexpr double kDt = 0.001;        // of the robot's cycle [s]
  static constexpr double kCoasting = 0.020;  // for which it goes on without commands [s]

  // fraction: of the limits that is used, above 0 and at most 0.99 (sums are rounded). Throws
  // std::invalid_argument.
  RateLimiter(const JointLimits& limits, double fraction);

  // The robot goes at v with acceleration a.
  void Start(const Joints& v, const Joints& a) noexcept;
  // What to tell it next. asked [rad/s]: what is not finite counts as rest. q: where it is
  // commanded to be [rad]. `missed`: states or commands were lost lately, so that it may have to
  // coast again: it is not made faster then.
  const Joints& Next(const Joints& asked, const Joints& q, bool missed) noexcept;
  const Joints& v() const noexcept { return v_; }
  const Joints& a() const noexcept { return a_; }
  bool AtRest() const noexcept;

 private:
  JointLimits limits_;  // as they are used
  Joints v_{}, a_{};
};

// Leads a robot that went its own way, since commands or states were lost, back to what is asked.
// The limits of its joints alone would let it leap back, which is a jerk of the handle.
class WayBack {
 public:
  static constexpr double kTime = 0.020;  // until it is there [s]

  // By which the robot differs from what is asked: velocity, acceleration.
  void Begin(const Joints& v, const Joints& a) noexcept;
  // What the difference may still be in the next millisecond [rad/s]; zero once it is over.
  Joints Next() noexcept;
  bool active() const noexcept { return time_ < kTime; }

 private:
  Joints v_{}, a_{};
  double time_ = kTime;  // since it began [s]
};

}  // namespace predictor::fci
