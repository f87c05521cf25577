// Rendering at random states of two arms: everywhere a verified solution, limits always, and no
// level yields to a lower one.
#include "haptics/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "haptics/limits.h"
#include "haptics/qp.h"
#include "haptics/tasks.h"
#include "support/allocation_guard.h"
#include "support/soak.h"
#include "two_arms.h"

namespace predictor {
namespace {

TEST(Renderer, HasAVerifiedSolutionEverywhereSoak) {
  TwoArms two;
  RandomStream random(1, "states");
  for (const double weight : {0.0, 0.01}) {
    const auto renderer = two.MakeRenderer(weight);
    RenderResult result;
    double worst = 0;
    const long states = Count(10'000, 500'000);
    for (long k = 0; k < states; ++k) {
      two.Draw(&random);
      const Status status = renderer->Render(two.arms_, two.target_, two.last_, &result);
      EXPECT_FALSE(result.failed) << "state " << k << ", residual " << result.kkt_residual;
      ASSERT_TRUE(status.ok());
      worst = std::max(worst, result.kkt_residual);
      for (int i = 0; i < kHands; ++i)
        for (int j = 0; j < 7; ++j) {
          ASSERT_LE(std::abs(result.v[i][j]), two.limits_[i].velocity[j] + 1e-9);
          // Beyond a limit, or at it, no motion further out.
          ASSERT_TRUE(two.q_[i][j] < two.limits_[i].upper[j] || result.v[i][j] <= 1e-9);
          ASSERT_TRUE(two.q_[i][j] > two.limits_[i].lower[j] || result.v[i][j] >= -1e-9);
        }
    }
    EXPECT_LE(worst, 1e-6);
    RecordProperty("worst_kkt_residual", std::to_string(worst));
  }
}

// The relative pose yields to limits, never to tracking: its weighted slack is what it would be
// without tracking at all.
TEST(Renderer, RelativePoseDoesNotYieldToTrackingSoak) {
  TwoArms two;
  RandomStream random(2, "priorities");
  const RenderingSpec& spec = two.scenario_.rendering;
  JointLimits joint_limits(spec, {two.limits_[0], two.limits_[1]});
  RelativePose relative(spec);
  Tracking tracking(spec, 0, kDt);
  Regularisation regularisation(spec);
  QpSolver solver(14, 0);
  QpSolution with, without;
  double worst = 0;
  for (long k = 0; k < Count(3'000, 100'000); ++k) {
    two.Draw(&random);
    std::array<Jacobian, kHands> J;
    std::array<Pose, kHands> X_WH;
    const std::array<int, kHands> offset = {0, 7};
    for (int i = 0; i < kHands; ++i) {
      two.arms_[i].data->FrameJacobian(*two.models_[i], two.handles_[i], &J[i]);
      X_WH[i] = two.arms_[i].data->FramePose(*two.models_[i], two.handles_[i]);
    }
    const RenderState state{two.arms_, J, X_WH, X_WH, offset, 14, two.target_, two.last_, kDt};
    Qp qp(14, 0);
    relative.AddTo(state, &qp);
    joint_limits.AddTo(state, 0, &qp);
    regularisation.AddTo(state, &qp);
    solver.Solve(qp, &without);
    ASSERT_TRUE(without.solved);
    tracking.AddTo(state, &qp);
    solver.Solve(qp, &with);
    ASSERT_TRUE(with.solved);
    Vector6 weight;
    weight << 1, 1, 1, 0.2, 0.2, 0.2;
    const double slack_with = relative.Slack(state, with.x.data()).cwiseProduct(weight).norm();
    const double slack_without =
        relative.Slack(state, without.x.data()).cwiseProduct(weight).norm();
    worst = std::max(worst, slack_with - slack_without);
  }
  EXPECT_LE(worst, 1e-4);  // [m/s]: 0.1 mm at the gain of (10), in the most unfavourable state
  RecordProperty("worst_yield", std::to_string(worst));
}

// Whatever its gain: handles that stand wrong to one another come together at a handle's caps.
TEST(RelativePose, AsksForNoMoreThanTheCaps) {
  RandomStream random(11, "caps");
  double fastest = 0, quickest = 0;
  for (int k = 0; k < 100; ++k) {
    TwoArms two;
    two.scenario_.rendering.relative_kp = two.scenario_.rendering.relative_ko = 50;
    const auto renderer = two.MakeRenderer();
    two.Draw(&random);
    for (JointVector& v : two.last_) v.setZero();
    for (FrameMotion& D : two.target_.handle) D.V_W.setZero();
    Pose& right = two.target_.handle[1].X_W;
    if (k % 2 == 0)
      right.p.x() += 0.3;
    else
      right.q = RotationFromVector({0, 0, 1}) * right.q;
    RenderResult result;
    for (int tick = 0; tick < 500; ++tick) {  // until no joint's acceleration counts any more
      ASSERT_TRUE(renderer->Render(two.arms_, two.target_, two.last_, &result).ok());
      two.last_ = result.v;
    }
    std::array<Twist, kHands> V;
    for (std::size_t i = 0; i < kHands; ++i) {
      Jacobian J;
      two.arms_[i].data->FrameJacobian(*two.models_[i], two.handles_[i], &J);
      V[i] = J * result.v[i];
    }
    const Pose X_D1D2 = two.target_.handle[0].X_W.Inverse() * two.target_.handle[1].X_W;
    const Pose left = two.data_[0].FramePose(*two.models_[0], two.handles_[0]);
    const Vector3 lever = left.q * X_D1D2.p;
    Twist rate = V[0] - V[1];
    rate.head<3>() += V[0].tail<3>().cross(lever);
    rate -= result.relative_slack;  // what was asked
    fastest = std::max(fastest, rate.head<3>().norm());
    quickest = std::max(quickest, rate.tail<3>().norm());
    EXPECT_LE(rate.head<3>().norm(), two.target_.speed_cap * 1.001);
    EXPECT_LE(rate.tail<3>().norm(), two.target_.rotation_cap * 1.001);
  }
  EXPECT_GT(fastest, 0.999 * 0.25);
  EXPECT_GT(quickest, 0.999 * 1.5);
}

// What is told to be active held the command where it is, by the definition of a multiplier.
TEST(Renderer, TellsWhichBoundsHoldTheCommand) {
  TwoArms two;
  const auto renderer = two.MakeRenderer();
  RandomStream random(5, "active");
  int held = 0, free = 0;
  for (int k = 0; k < 2000; ++k) {
    two.Draw(&random);
    RenderResult result;
    ASSERT_TRUE(renderer->Render(two.arms_, two.target_, two.last_, &result).ok());
    if (result.failed) continue;
    const Qp& qp = renderer->qp();
    for (int i = 0; i < kHands; ++i)
      for (int j = 0; j < 7; ++j) {
        const double v = result.v[static_cast<std::size_t>(i)][j];
        const double above = v - qp.lower()[7 * i + j], below = qp.upper()[7 * i + j] - v;
        const unsigned bit = 1U << static_cast<unsigned>(j);
        const bool at_lower = (result.at_lower[static_cast<std::size_t>(i)] & bit) != 0;
        const bool at_upper = (result.at_upper[static_cast<std::size_t>(i)] & bit) != 0;
        EXPECT_LT(at_lower ? std::abs(above) : 0, 1e-5);
        EXPECT_LT(at_upper ? std::abs(below) : 0, 1e-5);
        // The random targets lie on no bound by chance.
        EXPECT_TRUE(at_lower || at_upper || std::min(above, below) > 1e-12)
            << above << " " << below;
        (at_lower || at_upper ? held : free)++;
      }
  }
  EXPECT_GT(held, 1000);
  EXPECT_GT(free, 100);
}

TEST(Renderer, SlowsDownWithoutASolutionAndStopsAfterThreeTicks) {
  TwoArms two;
  RandomStream random(3, "failure");
  two.Draw(&random);
  for (int i = 0; i < kHands; ++i) two.last_[i].setConstant(7, 0.5);
  const auto renderer = two.MakeRenderer();
  two.target_.handle[0].V_W[0] = std::nan("");
  RenderResult result;
  for (int k = 0; k < 3; ++k) {
    const Status status = renderer->Render(two.arms_, two.target_, two.last_, &result);
    EXPECT_TRUE(result.failed);
    EXPECT_EQ(status.cause, k < 2 ? StopCause::kNone : StopCause::kQp);
    // The faster handle brakes harder and harder, by the jerk of a stop.
    const double factor = result.v[0][0] / two.last_[0][0];
    EXPECT_NEAR((1 - factor) * two.Speed(), two.scenario_.safety.stop_jerk * (k + 1) * kDt * kDt,
                1e-9);
    for (int i = 0; i < kHands; ++i)
      for (int j = 0; j < 7; ++j) EXPECT_NEAR(result.v[i][j], factor * two.last_[i][j], 1e-12);
    two.last_ = result.v;
  }
}

TEST(Renderer, TakesNothingFromTheHeap) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  TwoArms two;
  RandomStream random(4, "heap");
  const auto renderer = two.MakeRenderer(0.01);
  RenderResult result;
  for (auto& v : result.v) v.setZero(7);
  for (int k = 0; k < 2'000; ++k) {
    two.Draw(&random);
    test::AllocationGuard guard;
    (void)renderer->Render(two.arms_, two.target_, two.last_, &result);
    ASSERT_EQ(guard.count(), 0);
  }
}

// Pairs of either arm, and errors that say what is wrong with one.
TEST(LinkPairs, OfRealArmsAlwaysHaveTheElbows) {
  TwoArms two;
  Scenario& s = two.scenario_;
  s.rendering.link_pairs = {{"left:panda_link0", "left:panda_link8"}};
  EXPECT_EQ(LinkPairs(s, two.models_).size(), 1U);
  s.device.type = "real";
  const auto pairs = LinkPairs(s, two.models_);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[1].arm_a, 0);
  EXPECT_EQ(pairs[1].arm_b, 1);
}

TEST(LinkPairs, AreOfWhicheverArmTheyName) {
  Scenario s;
  s.device.left = Panda(0.25);
  s.left_handle = HandleSpec{};
  const auto load = [](const ArmSpec& a) {
    return RobotModel::Load({a.model, "", a.remove_links, a.base.ToPose()});
  };
  std::array<std::shared_ptr<const RobotModel>, kHands> models = {load(*s.device.left), nullptr};
  EXPECT_TRUE(LinkPairs(s, models).empty());  // no second elbow to keep away from

  s.rendering.link_pairs = {{"left:panda_link2", "left:panda_link8"}};
  const auto pairs = LinkPairs(s, models);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].arm_a, 0);
  EXPECT_EQ(pairs[0].arm_b, 0);

  const auto refusal = [&] {
    try {
      (void)LinkPairs(s, models);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  s.rendering.link_pairs = {{"panda_link4", "panda_link4"}};
  EXPECT_NE(refusal().find("there is no such arm"), std::string::npos) << refusal();
  s.rendering.link_pairs = {{"left:panda_link4", "left:panda_link4"}};
  EXPECT_NE(refusal().find("apart from itself"), std::string::npos) << refusal();
  s.rendering.link_pairs = {{"left:panda_link4", "left:panda_lonk4"}};
  EXPECT_NE(refusal().find("panda_lonk4"), std::string::npos) << refusal();
}

// Of one arm's own links, the damper slows the approach: its row is the rate of the distance.
TEST(LinkDistance, OfOneArmIsTheRateOfItsOwnDistance) {
  Scenario s;
  s.device.left = Panda(0.25);
  s.left_handle = HandleSpec{};
  s.rendering.link_pairs = {{"left:panda_link2", "left:panda_link7"}};
  const ArmSpec& spec = s.arm(0);
  const auto model = RobotModel::Load({spec.model, "", spec.remove_links, spec.base.ToPose()});
  LinkDistance distance(s.rendering, 2, LinkPairs(s, {model, nullptr}));
  RandomStream random(5, "pair");
  JointVector q(7), v(7);
  for (int j = 0; j < 7; ++j) q[j] = -0.5 + random.Uniform(), v[j] = random.Normal();
  q[3] = -1.5;
  const auto evaluate = [&](const JointVector& at, Qp* qp) {
    RobotData data(*model);
    data.UpdateKinematics(*model, at, v);
    RenderState state{{RenderArm{true, model.get(), &data, &data, {}, &at}, RenderArm{}},
                      {},
                      {},
                      {},
                      {0, 0},
                      7,
                      {},
                      {v, v},
                      kDt};
    distance.AddTo(state, 0, qp);
    return distance.nearest();
  };
  Qp qp(8, 1), unused(8, 1);
  evaluate(q, &qp);
  const double h = 1e-6;
  const double rate = (evaluate(q + h * v, &unused) - evaluate(q - h * v, &unused)) / (2 * h);
  EXPECT_NEAR(qp.A().row(0).head(7).dot(v), rate, 1e-7);
  EXPECT_GT(std::abs(rate), 1e-3);
}

}  // namespace
}  // namespace predictor
