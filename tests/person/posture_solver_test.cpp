#include "person/posture_solver.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "people.h"

namespace predictor::person {
namespace {

constexpr int kPostures = 200;

// Each pair of handles is placed at the hands of a random posture, which is drawn from the middle
// share of the joints' ranges.
TEST(PostureSolver, ReproducesThePositionsOfTheHands) {
  RandomStream random(1, "round trip");
  const BodyModel model{Man()};
  for (const bool turns : {false, true}) {
    const PostureSolver solver(model, SomeStance(), Grips(turns));
    int reached = 0;
    double worst = 0;
    for (int i = 0; i < kPostures; ++i) {
      const BodyVector truth = RandomPosture(model, &random, 0.6);
      const BodySample sample = SampleAt(model, SomeStance(), truth);
      const Posture posture = solver.Solve(sample);
      EXPECT_TRUE((posture.q.array() >= model.lower().array()).all());
      EXPECT_TRUE((posture.q.array() <= model.upper().array()).all());
      // The errors are computed by the forward kinematics, independently of the solver.
      const BodySample again = SampleAt(model, SomeStance(), posture.q);
      double error = 0;
      for (std::size_t k = 0; k < kHands; ++k)
        error = std::max(error, (again.hands[k].X_WD.p - sample.hands[k].X_WD.p).norm());
      EXPECT_NEAR(error, *std::ranges::max_element(posture.position_error), 1e-12);
      for (std::size_t k = 0; k < kHands; ++k) {
        const Vector3 bar = sample.hands[k].X_WD.q * Vector3::UnitX();
        const Vector3 held = again.hands[k].X_WD.q * Vector3::UnitX();
        const double angle = std::atan2(bar.cross(held).norm(), bar.dot(held));
        EXPECT_NEAR(angle, turns ? posture.oblique[k] : 0, posture.reached ? 1e-6 : 3.2);
        EXPECT_NEAR(posture.rotation_error[k], turns ? std::max(0.0, angle - 0.7) : 0, 1e-6);
      }
      worst = std::max(worst, error);
      reached += posture.reached;
    }
    std::printf("turns %d: reached %d of %d, worst %.2g m\n", turns, reached, kPostures, worst);
    EXPECT_LT(worst, 1e-6);
    // A hand that may turn may prefer a posture in which the bar lies too obliquely.
    EXPECT_GE(reached, kPostures * (turns ? 95 : 98) / 100);
  }
}

// Returns both handles at places that a person in front of them can reach. `phase` moves the
// handles along a circle.
BodySample BeforeThePerson(const Stance& stance, double phase) {
  BodySample sample;
  for (int hand = 0; hand < kHands; ++hand) {
    HandSample& measured = sample.hands[static_cast<std::size_t>(hand)];
    Pose X_SD = GripOn({0.2, 0, 1}, {-1, 0, 0});
    X_SD.p = {0.4 + 0.1 * std::cos(phase), (hand == 0 ? 0.2 : -0.2), 1.15 + 0.1 * std::sin(phase)};
    measured.present = true;
    measured.X_WD = stance.X_WS * X_SD;
  }
  return sample;
}

TEST(PostureSolver, SaysWhatIsMissingToAHandleOutOfReach) {
  const BodyModel model{Man()};
  const PostureSolver solver(model, SomeStance(), Grips(true));
  BodySample sample = BeforeThePerson(SomeStance(), 0);
  const Vector3 ahead = SomeStance().X_WS.q * Vector3::UnitX();
  for (HandSample& hand : sample.hands) hand.X_WD.p += 2 * ahead;
  const Posture posture = solver.Solve(sample);
  EXPECT_FALSE(posture.reached);
  // The maximum reach is 0.3 m for the hips, 0.6 m for the trunk and 0.65 m for the arms.
  EXPECT_GT(posture.position_error[0], 2.4 - 0.3 - 0.6 - 0.65);
  const BodySample hands = SampleAt(model, SomeStance(), posture.q);
  for (std::size_t k = 0; k < kHands; ++k)
    EXPECT_NEAR((hands.hands[k].X_WD.p - sample.hands[k].X_WD.p).norm(), posture.position_error[k],
                1e-12);
  // In no nearby posture may the hands be nearer to the handles.
  RandomStream random(2, "nearby");
  const auto distance = [&](const BodyVector& q) {
    const BodySample at = SampleAt(model, SomeStance(), q);
    double sum = 0;
    for (std::size_t k = 0; k < kHands; ++k)
      sum += (at.hands[k].X_WD.p - sample.hands[k].X_WD.p).squaredNorm();
    return sum;
  };
  const double found = distance(posture.q);
  for (int i = 0; i < 2000; ++i) {
    const BodyVector q =
        (posture.q + RandomVector(&random, 0.02)).cwiseMax(model.lower()).cwiseMin(model.upper());
    EXPECT_GT(distance(q), found - 1e-9);
  }
}

TEST(PostureSolver, DependsOnSampleAndStartAlone) {
  const BodyModel model{Woman()};
  const PostureSolver used(model, SomeStance(), Grips(true));
  for (int i = 0; i < 20; ++i) {
    const BodySample sample = BeforeThePerson(SomeStance(), 0.3 * i);
    const PostureSolver fresh(model, SomeStance(), Grips(true));
    EXPECT_EQ(used.Solve(sample).q, fresh.Solve(sample).q);
  }
}

// Along a path, the solver must find the same posture whether it starts at the previous posture or
// at the comfortable one. The posture must move as smoothly as the handles. The bounds are the
// second differences of a circle times 10 rad/m. Where a joint reaches a limit, the bounds are
// twice as large.
TEST(PostureSolver, FollowsASmoothPathSmoothly) {
  const BodyModel model{Man()};
  const PostureSolver solver(model, SomeStance(), Grips(true));
  constexpr double kStep = 0.02;
  BodyVector q = solver.Solve(BeforeThePerson(SomeStance(), -kStep)).q, last = q;
  const BodyVector first = q;
  for (int i = 0; i * kStep < 2 * kPi; ++i) {
    const BodySample sample = BeforeThePerson(SomeStance(), kStep * i);
    const BodyVector next = solver.Solve(sample, q).q;
    EXPECT_LT((next - solver.Solve(sample).q).cwiseAbs().maxCoeff(), 1e-4);
    if (i > 0) {
      EXPECT_LT((next - 2 * q + last).cwiseAbs().maxCoeff(), 20 * 0.1 * kStep * kStep);
    }
    last = q;
    q = next;
  }
  EXPECT_LT((q - first).cwiseAbs().maxCoeff(), 0.05);  // back at the first posture
}

// Measured positions of the elbows and the head must pull the model's elbows and head away from the
// prior.
TEST(PostureSolver, FollowsMeasuredElbowsAndHead) {
  RandomStream random(5, "elbows");
  const BodyModel model{Man()};
  const PostureSolver solver(model, SomeStance(), Grips(true));
  const auto elbow = [&](const BodyVector& q) {
    return Vector3(SomeStance().X_WS * Place(model, q).p[Of(0, ArmJoint::kElbowFlexion)]);
  };
  const auto head = [&](const BodyVector& q) {
    return SomeStance().X_WS * Place(model, q).FrameOf(kNeckTwist) *
           Pose{model.anthropometry().eyes, Quaternion::Identity()};
  };
  Vector3 without = Vector3::Zero(), with = Vector3::Zero();  // of elbow and head [m], head [rad]
  for (int i = 0; i < 50; ++i) {
    const BodyVector truth = (solver.prior().comfort + RandomVector(&random, 0.1))
                                 .cwiseMax(model.lower())
                                 .cwiseMin(model.upper());
    BodySample sample = SampleAt(model, SomeStance(), truth);
    const auto error = [&](const BodyVector& q) {
      return Vector3((elbow(q) - elbow(truth)).norm(), (head(q).p - head(truth).p).norm(),
                     RotationError(head(q).q, head(truth).q).norm());
    };
    without += error(solver.Solve(sample).q);
    sample.p_WElbow[0] = elbow(truth);
    sample.X_WHead = head(truth);
    const Posture posture = solver.Solve(sample);
    EXPECT_TRUE(posture.reached);
    with += error(posture.q);
    EXPECT_NEAR(posture.elbow_error[0], error(posture.q)[0], 1e-12);
    EXPECT_NEAR(posture.head_error, error(posture.q)[1], 1e-12);
  }
  for (int i = 0; i < 3; ++i) EXPECT_LT(with[i], without[i] / 3) << i;
}

TEST(PostureSolver, RejectsNonFiniteTargets) {
  const PostureSolver solver(BodyModel{Man()}, SomeStance(), Grips(true));
  for (const double bad : {std::nan(""), HUGE_VAL, 1e300}) {
    BodySample sample = BeforeThePerson(SomeStance(), 0);
    sample.hands[0].X_WD.p.x() = bad;
    const Posture posture = solver.Solve(sample);
    EXPECT_FALSE(posture.reached);
    EXPECT_TRUE(posture.q.allFinite());
  }
}

TEST(PostureSolver, LeavesAnAbsentHandAtItsComfort) {
  const BodyModel model{Man()};
  const PostureSolver solver(model, SomeStance(), Grips(true));
  BodySample sample = BeforeThePerson(SomeStance(), 0);
  sample.hands[1].present = false;
  const Posture posture = solver.Solve(sample);
  EXPECT_TRUE(posture.reached);
  EXPECT_LT((posture.q - solver.prior().comfort).segment<kArmJoints>(kRightArm).norm(), 1e-3);
  EXPECT_EQ(posture.position_error[1], 0);
}

TEST(Stance, RefusesInvalidDirectionsAndWidths) {
  EXPECT_THROW(StanceAt({}, {0, 0, 1}), InputError);
  EXPECT_THROW(StanceAt({}, {0, 0, 0}), InputError);
  EXPECT_THROW(StanceAt({}, {1, 0, 0}, -0.1), InputError);
  EXPECT_THROW(StanceAt({}, {1, 0, 0}, std::nan("")), InputError);
  const Stance stance = StanceAt({1, 2, 3}, {0, 2, 1});
  EXPECT_NEAR((stance.X_WS * Vector3(1, 0, 0) - Vector3(1, 3, 3)).norm(), 0, 1e-12);
}

TEST(Grip, HasItsBarAlongXAndItsWristTowardsZ) {
  const Pose X_DG = GripOn({0, 0, 2}, {-1, 0, 5});
  EXPECT_NEAR((X_DG.q * Vector3::UnitX() - Vector3::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR((X_DG.q * Vector3::UnitZ() + Vector3::UnitX()).norm(), 0, 1e-12);
  EXPECT_THROW(GripOn({0, 0, 1}, {0, 0, 1}), InputError);
  EXPECT_THROW(GripOn({0, 0, 0}, {0, 0, 1}), InputError);
}

}  // namespace
}  // namespace predictor::person
