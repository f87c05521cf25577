#include "muscles/arm_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "muscles/arms.h"

namespace predictor::muscles {
namespace {

BodySpec SmallWoman() {
  BodySpec spec;
  spec.sex = Sex::kFemale;
  spec.height = 1.55;
  spec.mass = 52;
  return spec;
}

TEST(ArmModel, TableIsComplete) {
  std::set<std::string> keys;
  std::set<MuscleGroup> groups;
  for (const MuscleSpec& muscle : MuscleTable()) {
    EXPECT_TRUE(keys.insert(muscle.key).second) << muscle.key;
    groups.insert(muscle.group);
    EXPECT_NE(muscle.path[1].part, Part::kNone) << muscle.key;
    EXPECT_EQ(muscle.path[0].wrap, Wrap::kNone) << muscle.key;
    for (std::size_t i = 0; i < kMaxPathPoints; ++i)
      EXPECT_EQ(muscle.path[i].wrap != Wrap::kNone, muscle.path[i].radius > 0) << muscle.key;
  }
  EXPECT_EQ(groups.size(), static_cast<std::size_t>(kMuscleGroups));
}

// Compares R = -∂l/∂q with central differences of the length.
TEST(ArmModel, MomentArmsAreTheSlopesOfTheLengths) {
  constexpr double kStep = 1e-6;
  RandomStream random(1, "moment arms");
  for (int hand = 0; hand < kHands; ++hand) {
    const ArmModel arm(hand == 0 ? BodySpec{} : SmallWoman(), hand);
    double worst = 0;
    for (int n = 0; n < 200; ++n) {
      const ArmVector q = RandomArm(arm, &random);
      const MomentArms R = arm.LinesAt(q).moment_arm;
      for (int j = 0; j < person::kArmJoints; ++j) {
        const ArmVector step = kStep * ArmVector::Unit(j);
        const MuscleVector slope =
            (arm.LinesAt(q + step).length - arm.LinesAt(q - step).length) / (2 * kStep);
        worst = std::max(worst, (slope + R.row(j).transpose()).cwiseAbs().maxCoeff());
      }
    }
    EXPECT_LT(worst, 1e-7) << "[m] of hand " << hand;
  }
}

TEST(ArmModel, BothArmsAreMirrorImages) {
  const ArmModel left({}, 0), right({}, 1);
  RandomStream random(2, "mirror");
  for (int n = 0; n < 50; ++n) {
    const ArmVector q = RandomArm(left, &random), v = ArmVector::Constant(random.Normal());
    const MuscleLines a = left.LinesAt(q), b = right.LinesAt(q);
    EXPECT_LT((a.length - b.length).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((a.moment_arm - b.moment_arm).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((left.ForcesAt(a, v).active - right.ForcesAt(b, v).active).cwiseAbs().maxCoeff(),
              1e-9);
  }
}

// Muscle paths and moment arms must grow with the arm. If all segments of a body are 10 % longer,
// its moment arms are 10 % longer.
TEST(ArmModel, ScalesWithTheSegments) {
  BodySpec longer;
  const person::Anthropometry a = person::AnthropometryOf(longer);
  longer.upper_arm = 1.1 * a.upper_arm.length;
  longer.forearm = 1.1 * a.forearm.length;
  longer.hand = 1.1 * a.hand.length;
  const ArmModel arm({}, 1), scaled(longer, 1);
  const ArmVector q = WorkPosture();
  const MuscleLines before = arm.LinesAt(q), after = scaled.LinesAt(q);
  EXPECT_LT((after.moment_arm - 1.1 * before.moment_arm).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((after.length - 1.1 * before.length).cwiseAbs().maxCoeff(), 1e-12);
}

// The power of the muscles at the joints must equal the power of their tendons.
TEST(ArmModel, TorquesAndTendonsDoTheSamePower) {
  constexpr double kTime = 1e-6;
  const ArmModel arm({}, 1);
  RandomStream random(4, "power");
  const ArmVector q = WorkPosture();
  ArmVector v;
  for (int i = 0; i < person::kArmJoints; ++i) v[i] = random.Normal();
  const MuscleLines lines = arm.LinesAt(q);
  const MuscleVector rate =
      (arm.LinesAt(q + kTime * v).length - arm.LinesAt(q - kTime * v).length) / (2 * kTime);
  MuscleVector force;
  for (int i = 0; i < kMuscles; ++i) force[i] = 100 * random.Uniform();
  EXPECT_NEAR((lines.moment_arm * force).dot(v), -force.dot(rate), 1e-5);
}

TEST(ArmModel, TheLongestFibresOfTheWorkingRangeAreSet) {
  const ArmModel arm({}, 1);
  MuscleVector longest = MuscleVector::Zero();
  constexpr double kEnds[person::kArmJoints][2] = {{0, 90},   {0, 60},   {-30, 45}, {0, 130},
                                                   {-70, 70}, {-45, 45}, {-15, 25}};
  for (int corner = 0; corner < 128; ++corner) {
    ArmVector q;
    for (int i = 0; i < person::kArmJoints; ++i) q[i] = Radians(kEnds[i][corner >> i & 1]);
    longest = longest.cwiseMax(arm.ForcesAt(arm.LinesAt(q), ArmVector::Zero()).fibre_length);
  }
  for (int i = 0; i < kMuscles; ++i) {
    const char* key = MuscleTable()[static_cast<std::size_t>(i)].key;
    EXPECT_LT(longest[i], kLongestFibre + 1e-12) << key;
    EXPECT_TRUE(arm.muscle(i).tendon_slack == 0 || longest[i] > kLongestFibre - 1e-12) << key;
    EXPECT_GT(longest[i], 0.9) << key;
  }
}

// Each muscle must act at the joints in its name.
TEST(ArmModel, MusclesPullTheRightWay) {
  const ArmModel arm({}, 1);
  const MomentArms R = arm.LinesAt(WorkPosture()).moment_arm;
  const auto of = [&](const char* key, person::ArmJoint joint) {
    return R(static_cast<int>(joint), IndexOf(key));
  };
  using enum person::ArmJoint;
  EXPECT_GT(of("deltoid_anterior", kShoulderFlexion), 0.02);
  EXPECT_LT(of("deltoid_posterior", kShoulderFlexion), -0.01);
  EXPECT_LT(of("latissimus_lower", kShoulderFlexion), -0.02);
  EXPECT_GT(of("deltoid_middle", kShoulderAbduction), 0.015);
  EXPECT_LT(of("pectoralis_costal", kShoulderAbduction), -0.02);
  EXPECT_GT(of("subscapularis", kShoulderRotation), 0.015);
  EXPECT_LT(of("infraspinatus", kShoulderRotation), -0.015);
  EXPECT_LT(of("teres_minor", kShoulderRotation), -0.015);
  for (const char* key : {"biceps_long", "biceps_short", "brachialis", "brachioradialis"})
    EXPECT_GT(of(key, kElbowFlexion), 0.02) << key;
  for (const char* key : {"triceps_long", "triceps_lateral", "triceps_medial", "anconeus"})
    EXPECT_LT(of(key, kElbowFlexion), -0.005) << key;
  for (const char* key : {"biceps_long", "biceps_short", "supinator"})
    EXPECT_LT(of(key, kPronation), -0.004) << key;
  for (const char* key : {"pronator_teres", "pronator_quadratus"})
    EXPECT_GT(of(key, kPronation), 0.004) << key;
  for (const char* key : {"fcr", "fcu", "fds", "fdp"}) EXPECT_GT(of(key, kWristFlexion), 0.01);
  for (const char* key : {"ecrl", "ecrb", "ecu", "edc"}) EXPECT_LT(of(key, kWristFlexion), -0.005);
  for (const char* key : {"ecrl", "ecrb", "fcr"}) EXPECT_LT(of(key, kWristDeviation), -0.005);
  for (const char* key : {"ecu", "fcu"}) EXPECT_GT(of(key, kWristDeviation), 0.01);
}

// A small movement must change the moment arms only a little. No muscle path jumps to the other
// side of its obstacle within the working range.
TEST(ArmModel, LinesDoNotJumpInTheWorkingRange) {
  const ArmModel arm({}, 1);
  RandomStream random(9, "jumps");
  constexpr double kEnds[person::kArmJoints][2] = {{0, 90},   {0, 60},   {-30, 45}, {0, 130},
                                                   {-70, 70}, {-45, 45}, {-15, 25}};
  double worst = 0;
  for (int n = 0; n < 2000; ++n) {
    ArmVector q, step;
    for (int i = 0; i < person::kArmJoints; ++i) {
      q[i] = Radians(kEnds[i][0] + (kEnds[i][1] - kEnds[i][0]) * random.Uniform());
      step[i] = random.Normal();
    }
    step *= 1e-3 / step.norm();
    const MomentArms change = arm.LinesAt(q + step).moment_arm - arm.LinesAt(q).moment_arm;
    worst = std::max(worst, change.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-3) << "[m] within 0.001 rad";
}

}  // namespace
}  // namespace predictor::muscles
