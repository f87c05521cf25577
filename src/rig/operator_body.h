// Computes the posture, stiffness, strength, balance and fatigue of the simulated operator from the
// handles.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/filters.h"
#include "core/messages.h"
#include "ergonomics/fatigue.h"
#include "person/body_loads.h"
#include "person/posture_angles.h"
#include "person/posture_follower.h"
#include "rig/arm_ability.h"
#include "scenario/scenario.h"

namespace predictor {

// The posture is computed from the held handles at intervals of kPosturePeriod. Between these
// times, the stiffness approaches its new value with the time constant kStiffnessTime.
class OperatorBody {
 public:
  static constexpr double kPosturePeriod = 0.04;  // [s]
  static constexpr double kStiffnessTime = 0.1;   // [s]

  // The scenario must have a body and a stance. Throws InputError if the values of the body are
  // impossible for an adult.
  explicit OperatorBody(const Scenario& scenario);

  // Restores the initial state: a rested person (except for body.fatigue) in a comfortable posture.
  void Reset() noexcept;
  // Advances by dt [s]. `holds` are the hands that hold their handles.
  void Step(const std::array<FrameMotion, kHands>& handle, const std::array<bool, kHands>& holds,
            double dt) noexcept;

  const ArmAbility& arm(int hand) const { return arms_[static_cast<std::size_t>(hand)]; }
  const Standing& standing() const { return standing_; }
  // Returns the point nearest to p that the hand can reach from the present position of the
  // shoulder.
  Vector3 Reachable(int hand, const Vector3& p) const noexcept;
  // Reduces each hand's force on its handle at p, in W, to the force that the joints can exert.
  // Afterwards, reduces the forward and the lateral components of all forces to those that the
  // person can exert without falling forwards or sideways.
  void LimitForces(const std::array<FrameMotion, kHands>& handle,
                   std::array<Vector3, kHands>* forces) const noexcept;
  // Records the wrenches that the hands exert. The wrenches determine the stiffness and fatigue of
  // the muscles.
  void Feel(const std::array<Wrench, kHands>& F_H_W) noexcept;

  void Archive(StateArchive& a) {
    a(q_, next_, arms_, standing_, muscles_, exerted_, steps_, begun_);
    if (steps_ < 0 || steps_ > kMaxSteps) a.Fail();
  }

 private:
  static constexpr int kMaxSteps = 1 << 16;  // limit for a saved state, per period
  // Fatigue of the joints of one arm, in the order of ArmAbility::joints.
  using Muscles = std::array<ergonomics::Compartments, kJudgedJoints>;

  void UpdatePosture(const std::array<FrameMotion, kHands>& handle,
                     const std::array<bool, kHands>& holds) noexcept;
  void UpdateArm(int hand, const person::Placement& at, const person::JointLoads& loads) noexcept;
  void UpdateStiffness(int hand, const person::Placement& at) noexcept;
  void UpdateStanding() noexcept;
  void Tire(double time) noexcept;
  void Smooth(double dt) noexcept;
  // Returns the strength of a joint in both directions in the present posture, when rested [N·m].
  JointAbility StrengthOf(int hand, int joint, const person::ArmAngles& angles) const noexcept;
  Vector3 GripOf(int hand, const person::Placement& at) const noexcept;  // in S

  BodySpec body_;
  person::PostureFollower follower_;
  person::BodyDynamics dynamics_;
  std::array<Vector3, kHands> p_JG_;  // position of the grip relative to the wrist's last joint [m]
  double shortest_ = 0, longest_ = 0;

  person::BodyVector q_;
  std::array<ArmAbility, kHands> next_, arms_;
  Standing standing_;
  std::array<Muscles, kHands> muscles_;
  std::array<Wrench, kHands> exerted_ = {Wrench::Zero(), Wrench::Zero()};  // mean since the update
  int steps_ = 0;       // steps since the posture's last update
  bool begun_ = false;  // the posture was updated since Reset
};

}  // namespace predictor
