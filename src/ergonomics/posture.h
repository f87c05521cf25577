// A person's posture and exertion, which RULA, REBA and OWAS assess.
//
// All angles must be finite and in radians. The assessments do not check this. The sign of an angle
// gives the direction in which a joint bends, as stated for each member. Side bend and twist count
// equally in both directions.
#pragma once

#include <numbers>

namespace predictor::ergonomics {

constexpr double Degrees(double degrees) { return degrees * std::numbers::pi / 180; }

// The whole body except for the arms.
struct BodyPosture {
  double neck_flexion = 0;     // [rad] head relative to trunk, forward positive
  double neck_side_bend = 0;   // [rad] positive to the right
  double neck_twist = 0;       // [rad] positive to the left
  double trunk_flexion = 0;    // [rad] trunk relative to the vertical, forward positive
  double trunk_side_bend = 0;  // [rad] positive to the right
  double trunk_twist = 0;      // [rad] shoulders relative to pelvis, positive to the left
  double knee_flexion = 0;     // [rad] of the knee that is bent more; 0: straight
  bool on_both_feet = true;    // weight evenly on both feet, or seated with both feet supported
  bool sitting = false;
};

// One arm. The members have the same meaning for both arms. In a mirrored posture, the other arm
// therefore has the same values.
struct ArmPosture {
  double upper_arm_flexion = 0;    // [rad] relative to the trunk; 0: hangs; forward positive
  double upper_arm_abduction = 0;  // [rad] away from the body positive
  double upper_arm_rotation = 0;   // [rad] about its own axis, inwards positive; 0: neutral
  double elbow_flexion = 0;        // [rad] 0: straight
  double forearm_rotation = 0;     // [rad] pronation positive; 0: thumb up
  double wrist_flexion = 0;        // [rad] towards the palm positive
  double wrist_deviation = 0;      // [rad] towards the little finger positive
  bool shoulder_raised = false;
  bool supported = false;      // the arm rests on something, or the person leans
  bool across_or_out = false;  // the forearm crosses the midline or points out to the side
  bool over_shoulder = false;  // the hand or elbow is at or above the height of the shoulder
};

enum class Coupling { kGood, kFair, kPoor, kUnacceptable };

// The exertion of the person, and how often it occurs.
struct Exertion {
  double load = 0;                  // [kg] mass held, or force / g
  bool shock = false;               // sudden or rapidly rising force
  bool held = false;                // posture static for more than a minute
  bool repeated = false;            // four times a minute or more
  bool large_rapid_change = false;  // large rapid change of posture, or an unstable base
  Coupling coupling = Coupling::kGood;
};

// The worksheets were made for observers, who judge a posture with words such as "neutral",
// "twisted" or "abducted". A measured angle is never exactly zero, so limits are needed for these
// words. The values of these limits are a design choice, because no source states them. A report
// must state these limits with its scores.
struct PostureThresholds {
  double neutral = Degrees(5);             // |wrist| flexion, trunk upright, neck not in extension
  double side_or_twist = Degrees(10);      // neck, trunk: side bend or twist; wrist: deviation
  double abducted = Degrees(20);           // upper arm
  double rotated = Degrees(45);            // upper arm about its own axis (REBA only)
  double near_end_of_twist = Degrees(60);  // forearm rotation (RULA's wrist twist)
  double bent_back = Degrees(20);          // OWAS: bent, and also twisted
};
inline constexpr PostureThresholds kDeclaredThresholds{};

// A conclusion in the words of the method.
struct Action {
  int level = 0;              // 1 is the lowest
  const char* sentence = "";  // static text
};

}  // namespace predictor::ergonomics
