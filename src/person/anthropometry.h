// Computes the masses, centres of mass, inertias and lengths of a person's segments from height,
// mass and sex.
//
// The following letters state the origin of each number. V: agrees with an independent copy (the
// biobuddy 0.3.2 package). R: quoted from memory of the literature. D: our choice.
#pragma once

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor::person {

// A rigid segment. In the upright posture, the arms hang and the thumbs point forward. In this
// posture, the segment's axes are x forward, y to the left and z up.
struct Segment {
  double mass = 0;                    // [kg]
  double length = 0;                  // [m]
  double com = 0;                     // position of the centre of mass from the proximal end [m]
  Vector3 inertia = Vector3::Zero();  // about the axes x, y, z through the centre of mass [kg·m²]
};

// The pelvis is de Leva's lower trunk (mid hip to omphalion), and the torso is de Leva's middle and
// upper trunk (omphalion to C7). The proximal ends are C7 for the head, the omphalion for the
// torso, the midpoint of the hip joints for the pelvis, and the heel for the foot.
struct Anthropometry {
  double height = 0;  // [m]
  double mass = 0;    // [kg]
  Segment head, torso, pelvis, upper_arm, forearm, hand, thigh, shank, foot;
  // The heights above the midpoint of the hip joints in the upright posture [m].
  double shoulder_height = 0, l5s1_height = 0;
  double l5s1_behind = 0;          // distance behind the line from the hips to C7 [m]
  double half_shoulder_width = 0;  // distance of a shoulder joint from the midplane [m]
  double half_hip_width = 0;       // distance of a hip joint from the midplane [m]
  double ankle_height = 0;         // height above the ground [m]
  Vector3 eyes = Vector3::Zero();  // midpoint of the eyes from C7, in the axes of the head [m]

  double hip_height() const { return ankle_height + shank.length + thigh.length; }  // [m]
};

// The masses, centres of mass, radii of gyration and lengths are those of de Leva, "Adjustments to
// Zatsiorsky-Seluyanov's segment inertia parameters", J. Biomech. 29 (1996) 1223-1230 (V; the
// shoulder height is R). Lengths are proportional to the person's height, and the inertia is m (r
// L)². Masses are scaled by at most 0.01 % so that they sum to the person's mass. The distance of
// the upper arm's centre of mass from the shoulder is 0.5772 of the upper arm's length for men and
// 0.5754 for women. The package biobuddy measures this fraction from the elbow, and Winter gives
// 0.436. The trunk is upright and straight, so the height of the head is the difference between the
// body's height and the sum of the other lengths. Further lengths, as fractions of the height:
// ankle 0.039 (Winter, R), hip joints 0.05 and shoulder joints 0.105 from the midplane (D), L5/S1
// 0.058 above (Chaffin & Andersson: a fifth of the way from hip to shoulder, R) and 0.018 behind
// the hips (D), eyes at 0.936 (Drillis & Contini, R). Throws InputError, with the key of BodySpec,
// for values that no adult has.
Anthropometry AnthropometryOf(const BodySpec& spec);

}  // namespace predictor::person
