#include "assessment/frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  constexpr double kOutside = 0.1;  // sideways from the shoulder; a design choice [m]
  ergonomics::ArmPosture arm;
  arm.upper_arm_flexion = a.upper_arm_flexion;
  arm.upper_arm_abduction = a.upper_arm_abduction;
  arm.upper_arm_rotation = a.upper_arm_rotation;
  arm.elbow_flexion = a.elbow_flexion;
  arm.forearm_rotation = a.forearm_twist;
  arm.wrist_flexion = a.wrist_flexion;
  arm.wrist_deviation = a.wrist_deviation;
  arm.across_or_out = a.hand_beside_midline < 0 || a.hand_beside_shoulder > kOutside;
  arm.over_shoulder = IsRaised(a);
  return arm;
}

// Returns the exertion of both hands. The load is the sum of the forces of both hands, so opposite
// forces of the hands do not count as a load.
ergonomics::Exertion ExertionOf(const FrameInput& input, const WorkPattern& work) {
  ergonomics::Exertion exertion;
  Vector3 force = Vector3::Zero();
  for (std::size_t h = 0; h < kHands; ++h) {
    if (!input.sample.hands[h].present) continue;
    force += input.sample.hands[h].F_D_W.head<3>();
    exertion.shock = exertion.shock || input.force_rate[h] > kShockRate;
  }
  exertion.load = force.norm() / kStandardGravity;
  exertion.held = work.held;
  exertion.repeated = work.repeated;
  exertion.coupling = work.coupling;
  return exertion;
}

void Score(const FrameInput& input, const WorkPattern& work, Frame* frame) {
  const ergonomics::BodyPosture body = BodyOf(frame->angles);
  const ergonomics::Exertion exertion = ExertionOf(input, work);
  const std::array<ergonomics::ArmPosture, kHands> arms = {ArmOf(frame->angles.arms[0]),
                                                           ArmOf(frame->angles.arms[1])};
  for (std::size_t h = 0; h < kHands; ++h) {
    if (!input.sample.hands[h].present) continue;
    const auto rula = ergonomics::AssessRula(body, arms[h], exertion);
    const auto reba = ergonomics::AssessReba(body, arms[h], exertion);
    if (rula.grand > frame->rula.grand) frame->rula = rula;
    if (reba.reba > frame->reba.reba) frame->reba = reba;
  }
  frame->owas = ergonomics::AssessOwas(body, arms[0], arms[1], exertion.load);
}

struct StrengthUse {
  double use = kUnknownValue;      // torque divided by strength
  double capable = kUnknownValue;  // share of people who are strong enough
};

StrengthUse UseOf(double torque, StrengthDirection flexion, StrengthDirection extension, Sex sex,
                  const person::ArmAngles& arm, const WorkPattern& work) {
  const StrengthDirection direction = torque > 0 ? flexion : extension;
  const double mean = ergonomics::MeanStrength(direction, sex, std::numbers::pi - arm.elbow_flexion,
                                               arm.upper_arm_flexion);
  const double strength = mean * work.strength[static_cast<std::size_t>(direction)];
  return {std::abs(torque) / std::max(strength, 1e-9),
          ergonomics::ShareCapable(std::abs(torque), mean)};
}

void AddStrength(Sex sex, const WorkPattern& work, Frame* frame) {
  for (int hand = 0; hand < kHands; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    const person::ArmAngles& arm = frame->angles.arms[h];
    const StrengthUse elbow =
        UseOf(frame->loads.torque[person::Of(hand, ArmJoint::kElbowFlexion)],
              StrengthDirection::kElbowFlexion, StrengthDirection::kElbowExtension, sex, arm, work);
    const StrengthUse shoulder =
        IsRaised(arm) ? StrengthUse()
                      : UseOf(frame->loads.torque[person::Of(hand, ArmJoint::kShoulderFlexion)],
                              StrengthDirection::kShoulderFlexion,
                              StrengthDirection::kShoulderExtension, sex, arm, work);
    frame->elbow_use[h] = elbow.use;
    frame->elbow_capable[h] = elbow.capable;
    frame->shoulder_use[h] = shoulder.use;
    frame->shoulder_capable[h] = shoulder.capable;
  }
}

Frame UnknownFrame() {
  Frame frame;
  frame.known = false;
  person::ForEachAngle(frame.angles, [](const char*, double& angle) { angle = kUnknownValue; });
  frame.loads.torque.setConstant(kUnknownValue);
  frame.loads.overload.setConstant(kUnknownValue);
  frame.loads.shoulder_moment.fill(kUnknownValue);
  person::ForEachBodyValue(frame.loads, [](const char*, double& load) { load = kUnknownValue; });
  frame.elbow_use.fill(kUnknownValue);
  frame.shoulder_use.fill(kUnknownValue);
  frame.elbow_capable.fill(kUnknownValue);
  frame.shoulder_capable.fill(kUnknownValue);
  return frame;
}

// Returns the value of an arm's joint, or not a number if it belongs to a raised shoulder.
double KnownAt(const Frame& frame, int hand, ArmJoint joint, const person::BodyVector& values) {
  const bool raised = IsRaised(frame.angles.arms[static_cast<std::size_t>(hand)]);
  return raised && joint <= ArmJoint::kShoulderRotation ? kUnknownValue
                                                        : values[person::Of(hand, joint)];
}

}  // namespace

double LiftMoment(const Frame& frame) {
  return std::abs(frame.loads.overload[person::kTorsoFlexion]);
}

bool IsRaised(const person::ArmAngles& arm) {
  return arm.upper_arm_elevation > std::numbers::pi / 2;
}

double TorqueOf(const Frame& frame, int hand, ArmJoint joint) {
  return KnownAt(frame, hand, joint, frame.loads.torque);
}

double OverloadOf(const Frame& frame, int hand, ArmJoint joint) {
  return KnownAt(frame, hand, joint, frame.loads.overload);
}

double ShoulderMoment(const Frame& frame, std::size_t hand) {
  return IsRaised(frame.angles.arms[hand]) ? kUnknownValue : frame.loads.shoulder_moment[hand];
}

Frame FrameOf(const FrameInput& input, const person::PostureAngles& angles,
              const person::BodyLoads& loads, const Reach& reach, Sex sex,
              const WorkPattern& work) {
  if (reach.miss > kLargestMiss) return UnknownFrame();
  Frame frame;
  frame.angles = angles;
  frame.loads = loads;
  frame.reached = reach.reached;
  Score(input, work, &frame);
  AddStrength(sex, work, &frame);
  return frame;
}

}  // namespace predictor::assessment
