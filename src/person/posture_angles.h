// Angles of a posture as ergonomic worksheets define them.
#pragma once

#include <array>

#include "person/legs.h"

namespace predictor::person {

struct ArmAngles {
  // The angle between the upper arm and the torso, in the torso's midplane [rad]. This angle is 0
  // along the torso, positive in front of the torso (flexion in RULA and REBA) and negative behind
  // the torso (extension).
  double upper_arm_flexion = 0;
  // The angle of the upper arm to the torso's midplane, positive away from the body [rad].
  double upper_arm_abduction = 0;
  // The angle of the upper arm to the vertical, from 0 (hanging) to π (up) (ISO 11226) [rad].
  double upper_arm_elevation = 0;
  double upper_arm_rotation = 0;  // rotation about the upper arm's own axis, positive inward [rad]
  double elbow_flexion = 0;       // 0 straight [rad]
  double wrist_flexion = 0;       // positive towards the palm, negative extension [rad]
  double wrist_deviation = 0;     // positive ulnar, negative radial [rad]
  double forearm_twist = 0;       // 0 with the thumb up, positive pronation (palm down) [rad]
  // The distance of the knuckles from the torso's midplane, towards the arm's own side [m]. The
  // value of hand_beside_midline is negative if the forearm crosses the midline, and larger than
  // the shoulder's distance if the forearm points outwards.
  double hand_beside_midline = 0;
  // hand_beside_midline minus the distance of the shoulder joint from the midplane [m]. This value
  // is positive if the hand is further out to the side than the shoulder.
  double hand_beside_shoulder = 0;
};

// The shoulder girdle does not move in this model, so a raised shoulder cannot be detected.
struct PostureAngles {
  std::array<ArmAngles, kHands> arms;
  // The angle between the torso and the vertical in the direction that the pelvis faces [rad]. This
  // angle is positive if the torso leans forward and negative in extension.
  double trunk_flexion = 0;
  double trunk_side_bend = 0;  // torso relative to the vertical, positive to the right [rad]
  double trunk_twist = 0;      // torso relative to the pelvis, positive to the left [rad]
  double neck_flexion = 0;     // head relative to the torso, positive forward [rad]
  double neck_side_bend = 0;   // positive to the right [rad]
  double neck_twist = 0;       // positive to the left [rad]
  std::array<double, kHands> knee_flexion = {};  // 0 straight [rad]
};

PostureAngles AnglesOf(const BodyModel& model, const BodyVector& q, double stance_width);

// Calls f(name, angle&) for every member, in this order: left arm, right arm, trunk, neck, knees.
template <class Angles, class F>
void ForEachAngle(Angles& angles, F f) {
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    auto& arm = angles.arms[hand];
    f(hand == 0 ? "left_upper_arm_flexion" : "right_upper_arm_flexion", arm.upper_arm_flexion);
    f(hand == 0 ? "left_upper_arm_abduction" : "right_upper_arm_abduction",
      arm.upper_arm_abduction);
    f(hand == 0 ? "left_upper_arm_elevation" : "right_upper_arm_elevation",
      arm.upper_arm_elevation);
    f(hand == 0 ? "left_upper_arm_rotation" : "right_upper_arm_rotation", arm.upper_arm_rotation);
    f(hand == 0 ? "left_elbow_flexion" : "right_elbow_flexion", arm.elbow_flexion);
    f(hand == 0 ? "left_wrist_flexion" : "right_wrist_flexion", arm.wrist_flexion);
    f(hand == 0 ? "left_wrist_deviation" : "right_wrist_deviation", arm.wrist_deviation);
    f(hand == 0 ? "left_forearm_twist" : "right_forearm_twist", arm.forearm_twist);
    f(hand == 0 ? "left_hand_beside_midline" : "right_hand_beside_midline",
      arm.hand_beside_midline);
    f(hand == 0 ? "left_hand_beside_shoulder" : "right_hand_beside_shoulder",
      arm.hand_beside_shoulder);
  }
  f("trunk_flexion", angles.trunk_flexion);
  f("trunk_side_bend", angles.trunk_side_bend);
  f("trunk_twist", angles.trunk_twist);
  f("neck_flexion", angles.neck_flexion);
  f("neck_side_bend", angles.neck_side_bend);
  f("neck_twist", angles.neck_twist);
  f("left_knee_flexion", angles.knee_flexion[0]);
  f("right_knee_flexion", angles.knee_flexion[1]);
}

}  // namespace predictor::person
