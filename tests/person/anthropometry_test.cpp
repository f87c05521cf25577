#include "person/anthropometry.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/error.h"
#include "people.h"
#include "person/legs.h"

namespace predictor::person {
namespace {

TEST(Anthropometry, MassesSumToThePersons) {
  for (const BodySpec& spec : {Man(), Woman()}) {
    const Anthropometry a = AnthropometryOf(spec);
    const double sum = a.head.mass + a.torso.mass + a.pelvis.mass +
                       2 * (a.upper_arm.mass + a.forearm.mass + a.hand.mass + a.thigh.mass +
                            a.shank.mass + a.foot.mass);
    EXPECT_NEAR(sum, spec.mass, 1e-12 * spec.mass);
  }
}

TEST(Anthropometry, StandsAsTallAsThePerson) {
  for (const BodySpec& spec : {Man(), Woman()}) {
    const Anthropometry a = AnthropometryOf(spec);
    EXPECT_NEAR(a.hip_height() + a.pelvis.length + a.torso.length + a.head.length, spec.height,
                1e-12);
    // According to Drillis & Contini, the hips are at 0.530 and the shoulders at 0.818 of the
    // body's height. The women in de Leva's table have longer trunks.
    EXPECT_NEAR(a.hip_height() / spec.height, 0.53, spec.sex == Sex::kMale ? 0.005 : 0.035);
    EXPECT_NEAR((a.hip_height() + a.shoulder_height) / spec.height, 0.818, 0.035);
    // According to Drillis & Contini, the lengths of upper arm and forearm are 0.186 and 0.146 of
    // the body's height. In de Leva's table, the joint centres are farther apart.
    EXPECT_NEAR(a.upper_arm.length / spec.height, 0.186, 0.03);
    EXPECT_NEAR(a.forearm.length / spec.height, 0.146, 0.01);
  }
}

// De Leva also gives values for the whole trunk. For men, the trunk has 0.4346 of the body's mass
// and a length of 603.3 mm. Its centre of mass is at 0.5138 of this length from C7, and its radii
// of gyration are 0.328, 0.306 and 0.169. For women, the corresponding values are 0.4257, 0.4964,
// 614.8 mm, 0.307,
// 0.292 and 0.147.
TEST(Anthropometry, PartsOfTheTrunkMakeTheWholeTrunk) {
  struct Whole {
    BodySpec spec;
    double mass, com, length;
    Vector3 radii;
  };
  Whole man = {Man(), .4346, .5138, .6033, {.328, .306, .169}};
  Whole woman = {Woman(), .4257, .4964, .6148, {.307, .292, .147}};
  man.spec.height = 1.741;
  woman.spec.height = 1.735;
  woman.spec.mass = 61.9;
  for (const Whole& whole : {man, woman}) {
    const Anthropometry a = AnthropometryOf(whole.spec);
    const double mass = a.pelvis.mass + a.torso.mass;
    EXPECT_NEAR(mass, whole.mass * whole.spec.mass, 0.02);
    EXPECT_NEAR(a.pelvis.length + a.torso.length, whole.length, 1e-9);
    const double torso_com = a.pelvis.length + a.torso.com;
    const double com = (a.pelvis.mass * a.pelvis.com + a.torso.mass * torso_com) / mass;
    EXPECT_NEAR(com, (1 - whole.com) * whole.length, 0.006);
    const double apart = torso_com - a.pelvis.com;
    const double parallel = a.pelvis.mass * a.torso.mass / mass * apart * apart;
    const Vector3 inertia = a.pelvis.inertia + a.torso.inertia + Vector3(parallel, parallel, 0);
    const Vector3 expected = mass * (whole.radii * whole.length).array().square();
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(inertia[i] / expected[i], 1, 0.12) << i;
  }
}

TEST(Anthropometry, MeasuredLengthsReplaceTheEstimate) {
  BodySpec spec = Man();
  spec.forearm = 0.3;
  const Anthropometry a = AnthropometryOf(spec), usual = AnthropometryOf(Man());
  EXPECT_EQ(a.forearm.length, 0.3);
  EXPECT_NEAR(a.forearm.com / usual.forearm.com, 0.3 / usual.forearm.length, 1e-12);
  EXPECT_EQ(a.upper_arm.length, usual.upper_arm.length);
  EXPECT_EQ(a.forearm.mass, usual.forearm.mass);
}

std::string Refusal(const BodySpec& spec) {
  try {
    AnthropometryOf(spec);
  } catch (const InputError& error) {
    return error.key() + "|" + error.what();
  }
  return "accepted";
}

TEST(Anthropometry, RefusesSizesThatNoAdultHas) {
  BodySpec giant = Man(), feather = Man(), stone = Man(), arm = Man(), legs = Man(), nan = Man();
  giant.height = 5;
  feather.mass = 31;
  stone.mass = 400;
  arm.upper_arm = 28;
  legs.thigh = 0.58;
  legs.shank = 0.58;
  nan.height = std::nan("");
  EXPECT_EQ(Refusal(giant),
            "height|height is 5 m, but for an adult it is 1.2 to 2.4 m. Give it in m.");
  EXPECT_EQ(Refusal(feather),
            "mass|mass is 31 kg at a height of 1.75 m, which is a body-mass index of 10.1 kg/m². "
            "Check both values. Indices from 12 to 70 kg/m² are possible.");
  EXPECT_EQ(Refusal(stone),
            "mass|mass is 400 kg, but for an adult it is 30 to 250 kg. Give it in kg.");
  EXPECT_EQ(
      Refusal(arm),
      "upper_arm|upper_arm is 28 m, but 0.198 to 0.396 m is possible for this height. Measure "
      "between the joints' centres, in m, or omit it.");
  EXPECT_EQ(Refusal(legs).substr(0, 45), "height|height is 1.75 m, but shank, thigh and");
  EXPECT_EQ(Refusal(nan).substr(0, 17), "height|height is ");
}

TEST(Legs, StandStraightAndBendWithTheLawOfCosines) {
  const BodyModel model{Man()};
  const Anthropometry& a = model.anthropometry();
  const double width = 2 * a.half_hip_width;
  const BodyLegs straight = LegsOf(model, BodyVector::Zero(), width);
  EXPECT_NEAR(straight.knee_flexion[0], 0, 1e-4);
  EXPECT_NEAR(straight.stretched, 0, 1e-12);
  BodyVector q = BodyVector::Zero();
  q[kPelvisZ] = -0.3;
  const BodyLegs bent = LegsOf(model, q, width);
  // The test finds the knee's angle by bisection and not by the product's formula.
  double low = 0, high = 3;
  for (int i = 0; i < 60; ++i) {
    const double knee = (low + high) / 2;
    const double apart = std::hypot(a.thigh.length + a.shank.length * std::cos(knee),
                                    a.shank.length * std::sin(knee));
    (apart > a.thigh.length + a.shank.length - 0.3 ? low : high) = knee;
  }
  EXPECT_NEAR(bent.knee_flexion[0], low, 1e-9);
  EXPECT_EQ(bent.knee_flexion[0], bent.knee_flexion[1]);
  EXPECT_GT(bent.com[0][0].x(), 0.05);  // the knees go forward
  q[kPelvisZ] = 0.02;
  EXPECT_NEAR(LegsOf(model, q, width).stretched, 0.02, 1e-9);
}

TEST(Legs, FootprintSurroundsBothFeet) {
  const Anthropometry a = AnthropometryOf(Man());
  const Footprint feet = FootprintOf(a, 0.3);
  EXPECT_NEAR(feet.front - feet.back, a.foot.length, 1e-12);
  EXPECT_LT(feet.back, 0);
  EXPECT_NEAR(feet.MarginOf(feet.front - 0.01, 0), 0.01, 1e-12);
  EXPECT_NEAR(feet.MarginOf(0, -feet.half_width - 0.02), -0.02, 1e-12);
}

}  // namespace
}  // namespace predictor::person
