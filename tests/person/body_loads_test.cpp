// Compares loads with equilibria computed by hand.
#include "person/body_loads.h"

#include <gtest/gtest.h>

#include <cmath>

#include "people.h"

namespace predictor::person {
namespace {

constexpr double kG = kStandardGravity;

class Loads : public testing::Test {
 protected:
  const BodyModel model{Man()};
  const Anthropometry a = model.anthropometry();
  const Stance stance = SomeStance();
  const BodyDynamics dynamics{model, stance};

  BodyLoads Static(const BodyVector& q, const BodySample& sample = {}) const {
    BodyMotion motion;
    motion.q = q;
    return dynamics.Evaluate(motion, sample);
  }

  // Returns hands at posture q that push the handles with `force` [N, in W].
  BodySample Pushing(const BodyVector& q, const Vector3& force) const {
    BodySample sample = SampleAt(model, stance, q);
    for (HandSample& hand : sample.hands) hand.F_D_W.head<3>() = force;
    return sample;
  }
};

// The forearm is level, so the elbow carries the weights of forearm and hand with their levers. The
// upper arm hangs, so the shoulder carries the same moment.
TEST_F(Loads, OfAStaticArmAreWeightTimesLever) {
  BodyVector q = BodyVector::Zero();
  for (int hand = 0; hand < kHands; ++hand) q[Of(hand, ArmJoint::kElbowFlexion)] = kPi / 2;
  const double own =
      kG * (a.forearm.mass * a.forearm.com + a.hand.mass * (a.forearm.length + a.hand.com));
  const double grip = a.forearm.length + 0.9 * a.hand.length;
  // Each hand carries 20 N. The hand pushes the handle up, and the handle pushes the hand down.
  const BodyLoads loads = Static(q, Pushing(q, {0, 0, 20}));
  for (int hand = 0; hand < kHands; ++hand) {
    const int elbow = Of(hand, ArmJoint::kElbowFlexion);
    EXPECT_NEAR(loads.torque[elbow], own + 20 * grip, 1e-9);
    EXPECT_NEAR(loads.overload[elbow], 20 * grip, 1e-9);
    const int shoulder = Of(hand, ArmJoint::kShoulderFlexion);
    EXPECT_NEAR(loads.torque[shoulder], own + 20 * grip, 1e-9);
  }
}

TEST_F(Loads, OfTheLowerBackFollowFromTheUpperBody) {
  const double upper =
      a.torso.mass + a.head.mass + 2 * (a.upper_arm.mass + a.forearm.mass + a.hand.mass);
  const BodyLoads standing = Static(BodyVector::Zero());
  // All centres of mass are on the line from the hips to the head, because the arms hang from this
  // line.
  const double moment = upper * kG * a.l5s1_behind;
  EXPECT_NEAR(standing.l5s1.flexion_moment, moment, 1e-9);
  EXPECT_NEAR(standing.l5s1.compression,
              upper * kG * std::cos(kSacralAngle) + moment / kBackMuscleArm, 1e-9);
  EXPECT_NEAR(standing.l5s1.shear, upper * kG * std::sin(kSacralAngle), 1e-9);
  EXPECT_NEAR(standing.l5s1.lateral_moment, 0, 1e-9);
  EXPECT_NEAR(standing.l5s1.twist_moment, 0, 1e-9);

  // The person carries 100 N in each hand, with the arms level and forward.
  BodyVector q = BodyVector::Zero();
  for (int hand = 0; hand < kHands; ++hand) q[Of(hand, ArmJoint::kShoulderFlexion)] = kPi / 2;
  const double lever = a.l5s1_behind + a.upper_arm.length + a.forearm.length + 0.9 * a.hand.length;
  EXPECT_NEAR(Static(q, Pushing(q, {0, 0, 100})).l5s1.flexion_moment -
                  Static(q, Pushing(q, {0, 0, 0})).l5s1.flexion_moment,
              200 * lever, 1e-9);
}

// A weight in the left hand must be balanced by muscles that bend to the right.
TEST_F(Loads, OfTheLowerBackHaveTheSignOfTheSide) {
  BodySample sample = SampleAt(model, stance, BodyVector::Zero());
  sample.hands[0].F_D_W.z() = 100;
  const BodyLoads loads = Static(BodyVector::Zero(), sample);
  const double palm = a.half_shoulder_width - 0.025;
  EXPECT_NEAR(loads.l5s1.lateral_moment, -100 * palm, 1e-9);
}

TEST_F(Loads, GroundCarriesTheWholeBodyUnderItsCentre) {
  const BodyLoads standing = Static(BodyVector::Zero());
  EXPECT_NEAR(standing.balance.ground_force, a.mass * kG, 1e-9);
  EXPECT_NEAR(standing.balance.y, 0, 1e-12);
  // Only the feet have their centres of mass in front of the ankles.
  const double foot = a.foot.com - 0.25 * a.foot.length;
  EXPECT_NEAR(standing.balance.x, 2 * a.foot.mass * foot / a.mass, 1e-9);
  EXPECT_GT(standing.balance.margin, 0.03);
  // If both hands at height h push forward with 60 N, the body tips backward, and the centre of
  // pressure moves by F h / W.
  BodyVector q = BodyVector::Zero();
  for (int hand = 0; hand < kHands; ++hand) q[Of(hand, ArmJoint::kElbowFlexion)] = kPi / 2;
  const Vector3 ahead = stance.X_WS.q * Vector3::UnitX();
  const BodyLoads pushing = Static(q, Pushing(q, 30 * ahead)), still = Static(q);
  const double height = a.hip_height() + a.shoulder_height - a.upper_arm.length;
  EXPECT_NEAR(pushing.balance.x - still.balance.x, -60 * height / (a.mass * kG), 2e-3);
  // No one can push with 300 N without leaning.
  EXPECT_LT(Static(q, Pushing(q, 150 * ahead)).balance.margin, 0);
}

// The power of the joints must equal the rate of change of the body's energy: τ v = d(kinetic +
// potential)/dt.
TEST_F(Loads, TorquesDoTheWorkOfTheMotion) {
  RandomStream random(3, "power");
  const auto energy = [&](const BodyVector& q, const BodyVector& v) {
    const Placement at = Place(model, q);
    double sum = 0;
    for (int i = 0; i < kBodyJoints; ++i) {
      const BodyJoint& joint = model.joint(i);
      const Vector3 com = at.FrameOf(i) * joint.com;
      const Vector6 V = JacobianAt(model, at, i, com) * v;
      const Vector3 w = at.R[static_cast<std::size_t>(i)].transpose() * V.tail<3>();
      sum += joint.mass * (V.head<3>().squaredNorm() / 2 + kG * com.z()) +
             w.dot(joint.inertia.cwiseProduct(w)) / 2;
    }
    return sum;
  };
  for (int i = 0; i < 20; ++i) {
    BodyMotion m{RandomPosture(model, &random), RandomVector(&random, 1), RandomVector(&random, 5)};
    constexpr double kStep = 1e-5;
    const auto after = [&](double t) {
      return energy(m.q + m.v * t + m.a * t * t / 2, m.v + m.a * t);
    };
    const double power = (after(kStep) - after(-kStep)) / (2 * kStep);
    EXPECT_NEAR(dynamics.Evaluate(m, {}).torque.dot(m.v), power, 1e-5 * (1 + std::abs(power)));
  }
}

// Returns the gain of the filter at a frequency, from a sine in the middle of a long record.
TEST(SmoothMotion, HasItsGainAndNoPhase) {
  constexpr double kDt = 0.005;
  const auto at = [&](double frequency, std::size_t i) {
    return std::sin(2 * kPi * frequency * kDt * static_cast<double>(i));
  };
  for (const double frequency : {0.5, 2.0, 6.0, 15.0}) {
    std::vector<BodyVector> q;
    for (std::size_t i = 0; i < 2000; ++i) q.push_back(BodyVector::Constant(at(frequency, i)));
    const std::vector<BodyMotion> motion = SmoothMotion(q, kDt);
    // The filter makes two passes of 1/(1 + (f/f_pass)⁴), with the frequencies of the bilinear
    // transform.
    const double ratio = std::tan(kPi * frequency * kDt) / std::tan(kPi * 6 / 0.802 * kDt);
    const double gain = 1 / (1 + std::pow(ratio, 4));
    const double w = 2 * kPi * frequency;
    for (std::size_t i = 900; i < 1100; ++i) {
      const double expected = gain * at(frequency, i);
      EXPECT_NEAR(motion[i].q[3], expected, 1e-6);
      EXPECT_NEAR(motion[i].a[3], -w * w * expected, 0.02 * w * w);
    }
  }
  EXPECT_NEAR(1 / (1 + std::pow(0.802, 4)), 1 / std::sqrt(2), 0.001);  // -3 dB at 6 Hz
}

TEST(SmoothMotion, KeepsALineToItsEnds) {
  std::vector<BodyVector> q;
  for (int i = 0; i < 100; ++i) q.push_back(BodyVector::Constant(1 + 0.02 * i));
  const std::vector<BodyMotion> motion = SmoothMotion(q, 0.01);
  ASSERT_EQ(motion.size(), q.size());
  for (std::size_t i = 0; i < q.size(); ++i) {
    EXPECT_NEAR(motion[i].q[0], q[i][0], 1e-3);
    EXPECT_NEAR(motion[i].v[0], 2, 0.05);
  }
  EXPECT_EQ(SmoothMotion(std::span(q).first(2), 0.01).size(), 2u);
  EXPECT_TRUE(SmoothMotion({}, 0.01).empty());
}

}  // namespace
}  // namespace predictor::person
