// What a Franka arm's own control does with joint velocities that it is told: differentiates them,
// holds them to its published limits, and goes on without them for a while.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <string>

#include "core/types.h"

namespace predictor {

using FrankaJoints = std::array<double, 7>;
FrankaJoints FrankaJointsOf(const JointVector& from);  // what is missing is zero

// Of one joint, as the arm holds it. Written down apart from the driver's, from Franka's "Robot and
// interface specifications"; Research 3: velocities by position from libfranka's test/fr3.urdf.
struct FrankaJointLimit {
  double lower, upper;              // of commanded positions [rad]
  double curve_lower, curve_upper;  // between which velocities are limited by the position [rad]
  double velocity, acceleration, jerk;
  double curve_deceleration, curve_offset;  // 0: the same velocity everywhere

  double FastestUp(double q) const;
  double FastestDown(double q) const;  // as a positive number
};
using FrankaLimits = std::array<FrankaJointLimit, 7>;
const FrankaLimits& FrankaLimitsOf(std::uint16_t version);

// The robot's description as it serves it (version 10).
std::string FrankaDescription();

class MotionCheck {
 public:
  static constexpr int kMostLost = 20;  // commands in a row; then the motion is aborted

  explicit MotionCheck(const FrankaLimits& limits) : limits_(limits) {}

  void Begin(const FrankaJoints& q);
  // What is wrong with the command, by the place in a state's errors; none: it is taken, or all
  // stays as it was.
  std::bitset<41> Take(const FrankaJoints& v);
  // The same of a millisecond without one: constant acceleration.
  std::bitset<41> Miss();

  const FrankaJoints& q() const { return q_; }
  const FrankaJoints& v() const { return v_; }
  const FrankaJoints& a() const { return a_; }
  int lost_in_a_row() const { return lost_; }

 private:
  std::bitset<41> Move(const FrankaJoints& v);

  FrankaLimits limits_;
  FrankaJoints q_{}, v_{}, a_{};
  int lost_ = 0;
};

}  // namespace predictor
