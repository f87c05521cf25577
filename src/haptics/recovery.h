// RECOVERY is the only motion without a simulation. RECOVERY only moves joints back into their
// permitted range, moves links apart, or moves a handle so that the hand is no longer pressed
// against an obstacle.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/messages.h"
#include "haptics/link_pairs.h"
#include "haptics/render_arm.h"
#include "scenario/scenario.h"

namespace predictor {

// The condition that prevents a run from starting.
enum class Beyond { kNothing, kJoint, kLinks };

// The place at which a joint or a link pair is beyond its limit.
struct BeyondPlace {
  Beyond what = Beyond::kNothing;
  int arm = -1, joint = -1;        // of the joint
  const LinkPair* pair = nullptr;  // the link pair
  double value = 0;                // joint position [rad], or distance of the links' origins [m]
  double low = 0, high = 0;        // permitted range of the value
};

class Recovery {
 public:
  // The maximum speed of a point of a handle [m/s]. Even with the overshoot of the arms, the speed
  // stays below 50 mm/s.
  static constexpr double kHandleSpeed = 0.049;
  static constexpr double kLength = 0.2;      // weight of rotation relative to translation [m]
  static constexpr double kJointSpeed = 0.2;  // maximum speed of a joint [rad/s]
  static constexpr double kInside = 0.002;    // distance that a joint moves inside its limit [rad]
  // Rendering stops a joint at its security distance with the accuracy of the encoder's resolution.
  // Therefore, a joint counts as beyond its limit only if it exceeds the limit by more than this
  // distance [rad].
  static constexpr double kJointMargin = 0.001;
  static constexpr double kForce = 5;  // smaller forces of the hand are ignored [N]

  // The entries of `models` for absent sides are null. Throws InputError.
  Recovery(const Scenario& scenario,
           const std::array<std::shared_ptr<const RobotModel>, kHands>& models);

  // Returns the first violation found. A violation is a joint that is nearer to its limit than
  // rendering.joint_security, or a pair of links that are nearer to each other than
  // rendering.security_distance. Rendering never moves the arms to such a position, and could not
  // move them out of it. Does not use the heap or throw.
  BeyondPlace Where(const std::array<RenderArm, kHands>& arms) const noexcept;
  Beyond Find(const std::array<RenderArm, kHands>& arms) const noexcept { return Where(arms).what; }

  // Computes joint velocities [rad/s] that reduce the violation found by Where. Without a
  // violation, each handle yields to a hand that presses on it. The power that the hand's wrench
  // has in this motion is therefore never negative. The velocities are zero if no motion is
  // necessary. Does not use the heap or throw.
  void Step(const std::array<RenderArm, kHands>& arms, const std::array<HandWrench, kHands>& wrench,
            std::array<JointVector, kHands>* v) const noexcept;

 private:
  bool JointsBack(const std::array<RenderArm, kHands>& arms,
                  std::array<JointVector, kHands>* v) const noexcept;
  bool LinksApart(const std::array<RenderArm, kHands>& arms,
                  std::array<JointVector, kHands>* v) const noexcept;
  // An arm on which a hand presses yields to this hand. An arm that is already moving back to its
  // permitted range yields only if its motion would increase the force on the hand.
  static void WithTheHands(const std::array<RenderArm, kHands>& arms,
                           const std::array<HandWrench, kHands>& wrench, bool goes_back,
                           std::array<JointVector, kHands>* v) noexcept;

  double security_distance_;
  // Range in which rendering keeps the joints [rad]
  std::array<JointVector, kHands> lower_, upper_;
  std::vector<LinkPair> pairs_;
};

}  // namespace predictor
