// Limits of the arms as bounds and rows of the QP. Adding one: docs/add-a-limit.md.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "core/messages.h"
#include "haptics/qp.h"
#include "haptics/render_arm.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// What a task or limit sees of a tick.
struct RenderState {
  const std::array<RenderArm, kHands>& arms;
  const std::array<Jacobian, kHands>& J;       // of the handles, axes of W
  const std::array<Pose, kHands>& X_WH;        // real handles
  const std::array<Pose, kHands>& X_WH_ahead;  // where they will be when the arms obey
  const std::array<int, kHands>& offset;       // of each arm's joints among the QP's variables
  int joints;                                  // of both arms; slack variables follow
  const RenderTarget& target;
  const std::array<JointVector, kHands>& last;  // command last sent [rad/s]
  double dt;                                    // [s]
};

class Limit {
 public:
  virtual ~Limit() = default;
  // Rows of A x ≥ b that this limit needs, each with a slack variable of its own.
  virtual int rows() const { return 0; }
  // Narrows bounds or writes rows `row` to `row + rows()`. No heap, no exception.
  virtual void AddTo(const RenderState& state, int row, Qp* qp) noexcept = 0;
};

// Largest speed [1/s] at which a distance [·] may shrink so that it never falls below zero when
// deceleration is at most `acceleration`: proportional near zero (velocity damper, slope
// `gain` [1/s]), a parabola beyond, joined smoothly; zero where the distance is negative.
double ApproachSpeed(double distance, double gain, double acceleration) noexcept;

// Bounds of an arm's joints as rendering and the guard use them: position [rad], velocity [rad/s]
// (80 % of the vendor's unless the scenario says otherwise), acceleration [rad/s²].
struct ArmLimits {
  JointVector lower, upper, velocity, acceleration;
};
// Throws InputError at the arm's key whose list does not fit the number of joints.
ArmLimits LimitsOf(const ArmSpec& spec, const RobotModel& model);

// Joint positions, velocities and accelerations, (13)–(15), as bounds. Position and velocity always
// hold; where one tick's acceleration does not suffice, acceleration yields.
class JointLimits final : public Limit {
 public:
  JointLimits(const RenderingSpec& spec, std::array<ArmLimits, kHands> arms)
      : spec_(spec), arms_(std::move(arms)) {}
  void AddTo(const RenderState& state, int row, Qp* qp) noexcept override;
  double acceleration(int arm, int joint) const {  // [rad/s²]
    return arms_[static_cast<std::size_t>(arm)].acceleration[joint];
  }

 private:
  RenderingSpec spec_;
  std::array<ArmLimits, kHands> arms_;
};

// Keeps pairs of links apart, (11) and (12): origins of two links, one row a pair.
class LinkDistance final : public Limit {
 public:
  struct Pair {
    int arm_a, arm_b;
    FrameId a, b;
  };
  LinkDistance(const RenderingSpec& spec, double acceleration, std::vector<Pair> pairs)
      : spec_(spec), acceleration_(acceleration), pairs_(std::move(pairs)) {}
  int rows() const override { return static_cast<int>(pairs_.size()); }
  void AddTo(const RenderState& state, int row, Qp* qp) noexcept override;
  double nearest() const { return nearest_; }  // of the last AddTo [m]

 private:
  RenderingSpec spec_;
  double acceleration_;  // with which the pairs can be braked [m/s²]
  std::vector<Pair> pairs_;
  double nearest_ = std::numeric_limits<double>::infinity();
};

// Pairs that a scenario keeps apart: those it names, otherwise the elbows. Throws InputError
// (unknown link, too many pairs).
std::vector<LinkDistance::Pair> LinkPairs(
    const Scenario& scenario, const std::array<std::shared_ptr<const RobotModel>, kHands>& models);

// What rendering keeps to: all limits in the order of their rows, and those that are asked by name.
struct Limits {
  std::vector<std::unique_ptr<Limit>> all;
  const JointLimits* joints = nullptr;
  const LinkDistance* links = nullptr;
};
// Throws InputError.
Limits MakeLimits(const Scenario& scenario,
                  const std::array<std::shared_ptr<const RobotModel>, kHands>& models);

}  // namespace predictor
