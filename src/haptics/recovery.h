// RECOVERY: the only motion without a simulation. Back within the joints' limits, links apart, or
// away from what presses on a hand; never anything else.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/messages.h"
#include "haptics/limits.h"
#include "haptics/render_arm.h"
#include "scenario/scenario.h"

namespace predictor {

// What keeps a run from starting.
enum class Beyond { kNothing, kJoint, kLinks };

class Recovery {
 public:
  // Most, of a handle's point [m/s]: what arms overshoot on top of it stays within 50 mm/s.
  static constexpr double kHandleSpeed = 0.049;
  static constexpr double kLength = 0.2;      // weighs rotation against translation [m]
  static constexpr double kJointSpeed = 0.2;  // most, of a joint [rad/s]
  static constexpr double kInside = 0.002;    // by which a joint comes back inside [rad]
  static constexpr double kForce = 5;         // a hand that presses less is free [N]

  // `models`: absent sides null. Throws InputError.
  Recovery(const Scenario& scenario,
           const std::array<std::shared_ptr<const RobotModel>, kHands>& models);

  // What is wrong with where the arms are, the first of: a joint beyond its limit, a pair of links
  // nearer than the security distance. No heap, no throw.
  Beyond Find(const std::array<RenderArm, kHands>& arms) const noexcept;

  // Joint velocities [rad/s] that undo what Find says; if it says nothing, ones that let each
  // handle go where its hand presses, if it presses: their power with the hand's wrench is never
  // negative. Zero if there is nothing to do. No heap, no throw.
  void Step(const std::array<RenderArm, kHands>& arms, const std::array<HandWrench, kHands>& wrench,
            std::array<JointVector, kHands>* v) const noexcept;

 private:
  bool JointsBack(const std::array<RenderArm, kHands>& arms,
                  std::array<JointVector, kHands>* v) const noexcept;
  bool LinksApart(const std::array<RenderArm, kHands>& arms,
                  std::array<JointVector, kHands>* v) const noexcept;
  // Arms whose hands are loaded go with them; where they go back already, those alone whose way
  // would press the hand more.
  static void WithTheHands(const std::array<RenderArm, kHands>& arms,
                           const std::array<HandWrench, kHands>& wrench, bool goes_back,
                           std::array<JointVector, kHands>* v) noexcept;

  double security_distance_;
  std::array<ArmLimits, kHands> limits_;
  std::vector<LinkDistance::Pair> pairs_;
};

}  // namespace predictor
