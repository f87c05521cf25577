#include "rig/operator_body.h"

#include <cmath>
#include <numbers>

#include "ergonomics/strength.h"
#include "rig/arm_stiffness.h"

namespace predictor {
namespace {

using ergonomics::FatigueJoint;
using ergonomics::StrengthDirection;
using person::ArmJoint;

constexpr int kFirstUpdates = 4;       // updates of the posture made at once when a run begins
constexpr double kMinCapacity = 0.05;  // smallest capacity, which bounds the noise (D)
constexpr FatigueJoint kTires[kJudgedJoints] = {FatigueJoint::kElbow, FatigueJoint::kShoulder};
constexpr ArmJoint kJoints[kJudgedJoints] = {ArmJoint::kElbowFlexion, ArmJoint::kShoulderFlexion};
constexpr StrengthDirection kFlexion[kJudgedJoints] = {StrengthDirection::kElbowFlexion,
                                                       StrengthDirection::kShoulderFlexion};
constexpr StrengthDirection kExtension[kJudgedJoints] = {StrengthDirection::kElbowExtension,
                                                         StrengthDirection::kShoulderExtension};

std::size_t At(int index) { return static_cast<std::size_t>(index); }

// The hand may grip at any angle about its bar, so only the bar's direction matters.
person::Grip HeldBy(const GripSpec& spec) {
  person::Grip grip;
  grip.kind = spec.kind;
  const bool is_zero = !(spec.bar.norm() > 0);  // refused by GripOn
  grip.X_DG = person::GripOn(spec.bar, is_zero ? Vector3::UnitX() : spec.bar.unitOrthogonal());
  return grip;
}

person::PostureSolver SolverOf(const Scenario& scenario) {
  const OperatorSpec& spec = scenario.operator_;
  std::array<person::Grip, kHands> grips;
  for (const int hand : scenario.hands()) grips[At(hand)] = HeldBy(scenario.handle(hand).grip);
  return {person::BodyModel(*spec.body), person::StanceOf(*spec.stance), grips};
}

}  // namespace

OperatorBody::OperatorBody(const Scenario& scenario)
    : body_(*scenario.operator_.body),
      follower_(SolverOf(scenario)),
      dynamics_(follower_.solver().model(), follower_.solver().stance()) {
  const person::BodyModel& model = follower_.solver().model();
  const person::Anthropometry& a = model.anthropometry();
  for (int hand = 0; hand < kHands; ++hand)
    p_JG_[At(hand)] = person::GripInHand(a, hand, follower_.solver().grips()[At(hand)].kind).p;
  const double fore = a.forearm.length + p_JG_[0].norm();
  const double bend = model.joint(person::Of(0, ArmJoint::kElbowFlexion)).upper;
  longest_ = a.upper_arm.length + fore;
  shortest_ = std::sqrt(a.upper_arm.length * a.upper_arm.length + fore * fore +
                        2 * a.upper_arm.length * fore * std::cos(bend));
  Reset();
}

void OperatorBody::Reset() noexcept {
  q_ = follower_.solver().prior().comfort;
  exerted_ = {Wrench::Zero(), Wrench::Zero()};
  for (Muscles& arm : muscles_) arm.fill({0, 1 - body_.fatigue, body_.fatigue});
  steps_ = 0;
  begun_ = false;
}

Vector3 OperatorBody::GripOf(int hand, const person::Placement& at) const noexcept {
  return at.FrameOf(person::Of(hand, ArmJoint::kWristDeviation)) * p_JG_[At(hand)];
}

void OperatorBody::Step(const std::array<FrameMotion, kHands>& handle,
                        const std::array<bool, kHands>& holds, double dt) noexcept {
  if (!begun_) {
    for (int i = 0; i < kFirstUpdates; ++i) UpdatePosture(handle, holds);
    arms_ = next_;
    begun_ = true;
  } else if (++steps_ * dt > kPosturePeriod - dt / 2) {
    Tire(steps_ * dt);
    UpdatePosture(handle, holds);
    exerted_ = {Wrench::Zero(), Wrench::Zero()};
    steps_ = 0;
  }
  Smooth(dt);
}

void OperatorBody::Smooth(double dt) noexcept {
  const double share = dt / (kStiffnessTime + dt);
  for (std::size_t i = 0; i < kHands; ++i) {
    arms_[i].stiffness += share * (next_[i].stiffness - arms_[i].stiffness);
    arms_[i].shoulder += share * (next_[i].shoulder - arms_[i].shoulder);
    arms_[i].joints = next_[i].joints;
    arms_[i].capacity = next_[i].capacity;
  }
}

void OperatorBody::UpdatePosture(const std::array<FrameMotion, kHands>& handle,
                                 const std::array<bool, kHands>& holds) noexcept {
  person::BodySample sample;
  for (std::size_t i = 0; i < kHands; ++i) {
    sample.hands[i].present = holds[i];
    sample.hands[i].X_WD = handle[i].X_W;
  }
  follower_.Follow(sample, &q_);
  const person::BodyModel& model = follower_.solver().model();
  const person::Placement at = person::Place(model, q_);
  const person::BodyVector rest = person::BodyVector::Zero();
  const person::JointLoads loads = person::InverseDynamics(model, q_, rest, rest, {});
  for (int hand = 0; hand < kHands; ++hand) {
    UpdateArm(hand, at, loads);
    UpdateStiffness(hand, at);
  }
  UpdateStanding();
}

JointAbility OperatorBody::StrengthOf(int hand, int joint,
                                      const person::ArmAngles& angles) const noexcept {
  const double elbow = std::numbers::pi - angles.elbow_flexion;  // included angle
  const auto strength = [&](StrengthDirection direction) {
    return ergonomics::MeanStrength(direction, body_.sex, elbow, angles.upper_arm_flexion) *
           body_.strength[static_cast<std::size_t>(direction)];
  };
  const double left = muscles_[At(hand)][At(joint)].capacity();
  return {0, Vector3::Zero(), -left * strength(kExtension[joint]),
          left * strength(kFlexion[joint])};
}

void OperatorBody::UpdateArm(int hand, const person::Placement& at,
                             const person::JointLoads& loads) noexcept {
  const person::Stance& stance = follower_.solver().stance();
  const person::PostureAngles angles =
      person::AnglesOf(follower_.solver().model(), q_, stance.width);
  ArmAbility& arm = next_[At(hand)];
  const Vector3 grip = GripOf(hand, at);
  arm.capacity = 1;
  for (int j = 0; j < kJudgedJoints; ++j) {
    const int joint = person::Of(hand, kJoints[j]);
    JointAbility& ability = arm.joints[At(j)];
    ability = StrengthOf(hand, j, angles.arms[At(hand)]);
    ability.at_rest = loads.torque[joint];
    ability.per_force = stance.X_WS.q * at.axis[At(joint)].cross(grip - at.p[At(joint)]);
    arm.capacity =
        std::max(kMinCapacity, std::min(arm.capacity, muscles_[At(hand)][At(j)].capacity()));
  }
  arm.shoulder = stance.X_WS * at.p[At(person::Of(hand, ArmJoint::kShoulderFlexion))];
}

void OperatorBody::UpdateStiffness(int hand, const person::Placement& at) noexcept {
  const Quaternion& q_WS = follower_.solver().stance().X_WS.q;
  const std::size_t shoulder = At(person::Of(hand, ArmJoint::kShoulderRotation));
  const std::size_t elbow = At(person::Of(hand, ArmJoint::kElbowFlexion));
  const ArmPoints points = {at.p[shoulder], at.p[elbow], GripOf(hand, at)};
  const ArmAxes axes = AxesOf(points);
  // `torque` contains the joint torques that balance the hand's wrench. The stiffness was measured
  // with a supported arm, so the torques that carry the arm are excluded.
  const Vector3 force = q_WS.conjugate() * exerted_[At(hand)].head<3>();
  const Vector3 moment = q_WS.conjugate() * exerted_[At(hand)].tail<3>();
  const auto about = [&](std::size_t joint) -> Vector3 {
    return moment + (points.hand - at.p[joint]).cross(force);
  };
  const Vector3 torque(axes.lateral.dot(about(shoulder)), axes.normal.dot(about(shoulder)),
                       axes.normal.dot(about(elbow)));
  const Matrix3 K = HandStiffness(points, body_.stiffness * JointStiffness(torque), -force);
  const Matrix3 R = q_WS.toRotationMatrix();
  next_[At(hand)].stiffness = R * K * R.transpose();
}

void OperatorBody::UpdateStanding() noexcept {
  person::BodyMotion motion;
  motion.q = q_;
  const person::Balance balance = dynamics_.Evaluate(motion, {}).balance;
  const person::Footprint feet =
      FootprintOf(follower_.solver().model().anthropometry(), follower_.solver().stance().width);
  standing_ = {balance.ground_force, balance.x, balance.y, feet.back, feet.front, feet.half_width};
}

void OperatorBody::Tire(double time) noexcept {
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    const Vector3 force = exerted_[hand].head<3>();
    for (std::size_t j = 0; j < kJudgedJoints; ++j) {
      const JointAbility& joint = next_[hand].joints[j];
      const double torque = joint.TorqueFor(force);
      // The load is compared with the strength of the rested muscles.
      const double strength = (torque > 0 ? joint.upper : -joint.lower) /
                              std::max(kMinCapacity, muscles_[hand][j].capacity());
      const double load = std::min(1.0, std::abs(torque) / std::max(strength, 1e-9));
      muscles_[hand][j] =
          Fatigued(muscles_[hand][j], load, time, ergonomics::FatigueRatesOf(kTires[j]));
    }
  }
}

void OperatorBody::Feel(const std::array<Wrench, kHands>& F_H_W) noexcept {
  for (std::size_t hand = 0; hand < kHands; ++hand)
    exerted_[hand] += (F_H_W[hand] - exerted_[hand]) / (steps_ + 1);
}

Vector3 OperatorBody::Reachable(int hand, const Vector3& p) const noexcept {
  return WithinReach(p, arms_[At(hand)].shoulder, shortest_, longest_);
}

void OperatorBody::LimitForces(const std::array<FrameMotion, kHands>& handle,
                               std::array<Vector3, kHands>* forces) const noexcept {
  const Pose X_SW = follower_.solver().stance().X_WS.Inverse();
  std::array<HandForce, kHands> in_S;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    Vector3& F = (*forces)[hand];
    F *= StrengthShare(arms_[hand], F);
    in_S[hand] = {X_SW * handle[hand].X_W.p, X_SW.q * F};
  }
  const BalanceShares share = BalanceSharesOf(standing_, in_S);
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    const Vector3& F = in_S[hand].F;
    (*forces)[hand] = X_SW.q.conjugate() * Vector3(share.x * F.x(), share.y * F.y(), F.z());
  }
}

BalanceShares BalanceSharesOf(const Standing& person, std::span<const HandForce> forces) {
  double N = person.weight, x = person.weight * person.x, y = person.weight * person.y;
  double tips_x = 0, tips_y = 0;
  for (const HandForce& hand : forces) {
    N += hand.F.z();
    x += hand.p.x() * hand.F.z();
    y += hand.p.y() * hand.F.z();
    tips_x -= hand.p.z() * hand.F.x();
    tips_y -= hand.p.z() * hand.F.y();
  }
  if (!(N > 0)) return {0, 0};
  return {LargestShare(x / N, tips_x / N, person.back, person.front),
          LargestShare(y / N, tips_y / N, -person.half_width, person.half_width)};
}

}  // namespace predictor
