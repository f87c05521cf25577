#include "assessment/frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ergonomics/strength.h"

namespace predictor::assessment {
namespace {

using ergonomics::StrengthDirection;
using person::ArmJoint;

ergonomics::BodyPosture BodyOf(const person::PostureAngles& a) {
  ergonomics::BodyPosture body;
  body.neck_flexion = a.neck_flexion;
  body.neck_side_bend = a.neck_side_bend;
  body.neck_twist = a.neck_twist;
  body.trunk_flexion = a.trunk_flexion;
  body.trunk_side_bend = a.trunk_side_bend;
  body.trunk_twist = a.trunk_twist;
  body.knee_flexion = std::max(a.knee_flexion[0], a.knee_flexion[1]);
  return body;
}

ergonomics::ArmPosture ArmOf(const person::ArmAngles& a) {
  constexpr double kOutside = 0.1;  // beside the shoulder, a design choice [m]
  ergonomics::ArmPosture arm;
  arm.upper_arm_flexion = a.upper_arm_flexion;
  arm.upper_arm_abduction = a.upper_arm_abduction;
  arm.upper_arm_rotation = a.upper_arm_rotation;
  arm.elbow_flexion = a.elbow_flexion;
  arm.forearm_rotation = a.forearm_twist;
  arm.wrist_flexion = a.wrist_flexion;
  arm.wrist_deviation = a.wrist_deviation;
  arm.across_or_out = a.hand_beside_midline < 0 || a.hand_beside_shoulder > kOutside;
  arm.over_shoulder = a.upper_arm_elevation > std::numbers::pi / 2;
  return arm;
}

ergonomics::Exertion ExertionOf(const FrameInput& input, std::size_t hand,
                                const WorkPattern& work) {
  ergonomics::Exertion exertion;
  exertion.load = input.sample.hands[hand].F_D_W.head<3>().norm() / kStandardGravity;
  exertion.shock = input.force_rate[hand] > kShockRate;
  exertion.held = work.held;
  exertion.repeated = work.repeated;
  exertion.coupling = work.coupling;
  return exertion;
}

void Score(const FrameInput& input, const WorkPattern& work, Frame* frame) {
  const ergonomics::BodyPosture body = BodyOf(frame->angles);
  std::array<ergonomics::ArmPosture, kHands> arms;
  double load = 0;  // of both hands [kg]
  const auto& hands = input.sample.hands;
  const bool none = !hands[0].present && !hands[1].present;
  for (std::size_t h = 0; h < kHands; ++h) {
    arms[h] = ArmOf(frame->angles.arms[h]);
    ergonomics::Exertion exertion;
    if (hands[h].present) exertion = ExertionOf(input, h, work);
    load += exertion.load;
    if (!hands[h].present && !none) continue;
    const auto rula = ergonomics::AssessRula(body, arms[h], exertion);
    const auto reba = ergonomics::AssessReba(body, arms[h], exertion);
    if (rula.grand > frame->rula.grand) frame->rula = rula;
    if (reba.reba > frame->reba.reba) frame->reba = reba;
  }
  frame->owas = ergonomics::AssessOwas(body, arms[0], arms[1], load);
}

double UseOf(double torque, StrengthDirection flexion, StrengthDirection extension, Sex sex,
             const person::ArmAngles& arm) {
  const StrengthDirection direction = torque > 0 ? flexion : extension;
  const double strength = ergonomics::MeanStrength(
      direction, sex, std::numbers::pi - arm.elbow_flexion, arm.upper_arm_flexion);
  return strength > 0 ? std::abs(torque) / strength : 0;
}

}  // namespace

Frame FrameOf(const FrameInput& input, const person::PostureAngles& angles,
              const person::BodyLoads& loads, bool reached, Sex sex, const WorkPattern& work) {
  Frame frame;
  frame.angles = angles;
  frame.loads = loads;
  frame.reached = reached;
  Score(input, work, &frame);
  for (int hand = 0; hand < kHands; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    frame.elbow_use[h] = UseOf(loads.torque[person::Of(hand, ArmJoint::kElbowFlexion)],
                               StrengthDirection::kElbowFlexion, StrengthDirection::kElbowExtension,
                               sex, angles.arms[h]);
    frame.shoulder_use[h] = UseOf(loads.torque[person::Of(hand, ArmJoint::kShoulderFlexion)],
                                  StrengthDirection::kShoulderFlexion,
                                  StrengthDirection::kShoulderExtension, sex, angles.arms[h]);
  }
  return frame;
}

}  // namespace predictor::assessment
