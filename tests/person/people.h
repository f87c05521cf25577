// The people, stances and postures of the tests.
#pragma once

#include <numbers>

#include "core/random.h"
#include "person/posture_solver.h"

namespace predictor::person {

inline constexpr double kPi = std::numbers::pi;

inline BodySpec Man() { return {}; }
inline BodySpec Woman() {
  BodySpec spec;
  spec.sex = Sex::kFemale;
  spec.height = 1.62;
  spec.mass = 60;
  return spec;
}

// Returns an arbitrary position and direction in the frame W.
inline Stance SomeStance() { return StanceAt({0.4, -1.2, -0.7}, {-1, 0.5, 0}, 0.3); }

// Each hand grips a bar along its handle's x axis, and its wrist is on the side of the z axis.
inline std::array<Grip, kHands> Grips(bool turns) {
  Grip grip;
  grip.turns = turns;
  return {grip, grip};
}

// Draws a random posture with a uniform distribution over the middle `share` of the joints' ranges.
inline BodyVector RandomPosture(const BodyModel& model, RandomStream* random, double share = 1) {
  const BodyVector lower = model.lower(), upper = model.upper();
  BodyVector q;
  for (int i = 0; i < kBodyJoints; ++i)
    q[i] = (lower[i] + upper[i]) / 2 + share * (upper[i] - lower[i]) * (random->Uniform() - 0.5);
  return q;
}

inline BodyVector RandomVector(RandomStream* random, double scale) {
  BodyVector v;
  for (int i = 0; i < kBodyJoints; ++i) v[i] = scale * random->Normal();
  return v;
}

// Returns the sample of hands at posture q, with handles at the grip frames.
inline BodySample SampleAt(const BodyModel& model, const Stance& stance, const BodyVector& q) {
  const Placement at = Place(model, q);
  BodySample sample;
  for (int hand = 0; hand < kHands; ++hand) {
    HandSample& measured = sample.hands[static_cast<std::size_t>(hand)];
    measured.present = true;
    measured.X_WD = stance.X_WS * at.FrameOf(Of(hand, ArmJoint::kWristDeviation)) *
                    GripInHand(model.anthropometry(), hand, GripKind::kPower);
  }
  return sample;
}

}  // namespace predictor::person
