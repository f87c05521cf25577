// Processes joint velocity commands as a Franka arm does. The check differentiates the commands and
// compares them with the published limits. If commands are missing, it extrapolates the motion for
// a while.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <string>

#include "core/types.h"

namespace predictor {

using FrankaJoints = std::array<double, 7>;
FrankaJoints FrankaJointsOf(const JointVector& from);  // missing values become zero

// The limits that the arm enforces for one joint, independent of the driver's limits. The limits
// come from Franka's "Robot and interface specifications". The position-dependent velocities of the
// Research 3 come from libfranka's test/fr3.urdf.
struct FrankaJointLimit {
  double lower, upper;              // of the commanded position [rad]
  double curve_lower, curve_upper;  // range with position-dependent velocity limits [rad]
  double velocity, acceleration, jerk;
  double curve_deceleration, curve_offset;  // 0: constant velocity limit

  double FastestUp(double q) const;
  double FastestDown(double q) const;  // magnitude
};
using FrankaLimits = std::array<FrankaJointLimit, 7>;
const FrankaLimits& FrankaLimitsOf(std::uint16_t version);

// Returns the robot description that the robot provides (version 10).
std::string FrankaDescription();

class MotionCheck {
 public:
  static constexpr int kMaxLost = 20;  // number of missing commands in a row that aborts the motion

  explicit MotionCheck(const FrankaLimits& limits) : limits_(limits) {}

  void Begin(const FrankaJoints& q);
  // Processes a command. Returns the errors of the motion, by their index in a state's list. The
  // motion advances only if there is no error.
  std::bitset<41> Take(const FrankaJoints& v);
  // Processes a millisecond without a command, in which the acceleration stays constant.
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
