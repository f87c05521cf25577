// Tests rendering at random states of two arms. The solution must be verified, the limits must
// hold, and no level may yield to a lower one.
#include "haptics/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "haptics/assemble.h"
#include "haptics/link_pairs.h"
#include "haptics/registry.h"
#include "qp/qp.h"
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
          // A joint at or beyond a limit must not move further out.
          ASSERT_TRUE(two.q_[i][j] < two.limits_[i].upper[j] || result.v[i][j] <= 1e-9);
          ASSERT_TRUE(two.q_[i][j] > two.limits_[i].lower[j] || result.v[i][j] >= -1e-9);
        }
    }
    EXPECT_LE(worst, 1e-6);
    RecordProperty("worst_kkt_residual", std::to_string(worst));
  }
}

// The relative pose may yield to limits but never to tracking. The weighted slack of the relative
// pose must be the same with and without tracking.
TEST(Renderer, RelativePoseDoesNotYieldToTrackingSoak) {
  TwoArms two;
  RandomStream random(2, "priorities");
  const RenderSetup setup(two.scenario_, two.models_, 0, kDt);
  const std::array<const char*, 1> limits = {"joint"};
  const std::array<const char*, 3> all = {"tracking", "relative_pose", "damping"};
  const std::array<const char*, 2> alone = {"relative_pose", "damping"};
  Assembler assemble_with(setup, all, limits), assemble_without(setup, alone, limits);
  double worst = 0;
  const auto weighted_slack = [&](Assembler* assembler) {
    const RenderContext context(two.arms_, two.target_, two.last_, kDt);
    Qp qp = assembler->MakeQp(Precedence::kWeights);
    assembler->Update(context);
    assembler->Assemble(context, Precedence::kWeights, &qp);
    QpSolution solution;
    QpSolver(qp.n(), qp.m()).Solve(qp, &solution);
    EXPECT_TRUE(solution.solved);
    Vector6 weight;
    weight << 1, 1, 1, 0.2, 0.2, 0.2;
    const TaskTerm relative = assembler->PrecedenceTerms().at(0);
    return relative.Slack(solution.x.data()).cwiseProduct(weight).norm();
  };
  for (long k = 0; k < Count(3'000, 100'000); ++k) {
    two.Draw(&random);
    const double with = weighted_slack(&assemble_with);
    const double without = weighted_slack(&assemble_without);
    ASSERT_FALSE(testing::Test::HasFailure());
    worst = std::max(worst, with - without);
  }
  EXPECT_LE(worst, 1e-4);  // [m/s]: 0.1 mm at the gain of (10), in the most unfavourable state
  RecordProperty("worst_yield", std::to_string(worst));
}

// Weights and rows are two forms of the same problem. If the slacks of the relative pose are equal,
// the rows belong to the task of keeping the relative pose.
TEST(Renderer, HasTheSameSolutionByWeightsAndByRows) {
  TwoArms two;
  RandomStream random(6, "forms");
  const RenderSetup setup(two.scenario_, two.models_, 0.02, kDt);
  Assembler assembler(setup);
  int compared = 0;
  for (int k = 0; k < 500; ++k) {
    two.Draw(&random);
    const RenderContext context(two.arms_, two.target_, two.last_, kDt);
    assembler.Update(context);
    std::array<Eigen::VectorXd, 2> x;
    std::array<RenderResult, 2> result;
    bool verified = true;
    for (const Precedence form : {Precedence::kWeights, Precedence::kRows}) {
      const auto f = static_cast<std::size_t>(form);
      Qp qp = assembler.MakeQp(form);
      assembler.Assemble(context, form, &qp);
      QpSolution solution;
      QpSolver(qp.n(), qp.m()).Solve(qp, &solution);
      verified = verified && KktResidual(qp, solution) <= 1e-9;
      x[f] = Eigen::Map<Eigen::VectorXd>(solution.x.data(), assembler.joints());
      assembler.Publish(solution.x.data(), &result[f]);
    }
    if (!verified) continue;
    ++compared;
    EXPECT_LT((x[0] - x[1]).lpNorm<Eigen::Infinity>(), 1e-4) << "state " << k;
    EXPECT_LT((result[0].relative_slack - result[1].relative_slack).lpNorm<Eigen::Infinity>(),
              1e-5);
  }
  EXPECT_GT(compared, 250);
}

// A single arm has no relative pose. The problem then has no rows for the relative pose, and both
// forms of the problem are identical.
TEST(Renderer, OfOneArmHasNoRowsOfTheRelativePose) {
  TwoArms two;
  two.models_[1] = nullptr;
  two.scenario_.right_handle.reset();
  two.scenario_.device.right.reset();
  const RenderSetup setup(two.scenario_, two.models_, 0.02, kDt);
  const Assembler assembler(setup);
  EXPECT_EQ(assembler.MakeQp(Precedence::kRows).m(), assembler.MakeQp(Precedence::kWeights).m());
  EXPECT_TRUE(assembler.PrecedenceTerms().empty());
}

// The renderer must publish each limit's slack under that limit's name. The states of this test
// have slack in the link pairs, because the elbows are too near each other and cannot separate fast
// enough.
TEST(Renderer, PublishesTheSlackOfEachLimit) {
  TwoArms two;
  two.scenario_.rendering.security_distance = 0.69;
  const auto renderer = two.MakeRenderer();
  RandomStream random(7, "slack");
  std::size_t link = 0;
  while (std::string(RegisteredLimits()[link]->name) != "link_distance") ++link;
  int yielding = 0;
  for (int k = 0; k < 500; ++k) {
    two.Draw(&random);
    RenderResult result;
    ASSERT_TRUE(renderer->Render(two.arms_, two.target_, two.last_, &result).ok());
    if (result.failed) continue;
    yielding += result.slack_by_limit[link] > 1e-3;
    for (std::size_t l = 0; l < result.slack_by_limit.size(); ++l) {
      EXPECT_TRUE(l == link || result.slack_by_limit[l] == 0);
      EXPECT_LE(result.slack_by_limit[l], result.limit_slack);
    }
  }
  EXPECT_GT(yielding, 10);
}

// Whatever the gain is, handles with a wrong relative pose must not approach each other faster than
// a handle's speed limits allow.
TEST(RelativePose, DemandsNoMoreThanTheCaps) {
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
    for (int tick = 0; tick < 500; ++tick) {  // until no joint's acceleration limit is active
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
    rate -= result.relative_slack;  // the rate that was requested
    fastest = std::max(fastest, rate.head<3>().norm());
    quickest = std::max(quickest, rate.tail<3>().norm());
    EXPECT_LE(rate.head<3>().norm(), two.target_.speed_cap * 1.001);
    EXPECT_LE(rate.tail<3>().norm(), two.target_.rotation_cap * 1.001);
  }
  EXPECT_GT(fastest, 0.999 * 0.25);
  EXPECT_GT(quickest, 0.999 * 1.5);
}

// By the definition of a multiplier, an active bound keeps the command at its value.
TEST(Renderer, PublishesTheActiveBounds) {
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
        // A random target never lies exactly on a bound.
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
    // The deceleration of the faster handle must increase with the jerk of a stop.
    const double factor = result.v[0][0] / two.last_[0][0];
    EXPECT_NEAR((1 - factor) * two.Speed(), two.scenario_.safety.stop_jerk * (k + 1) * kDt * kDt,
                1e-9);
    for (int i = 0; i < kHands; ++i)
      for (int j = 0; j < 7; ++j) EXPECT_NEAR(result.v[i][j], factor * two.last_[i][j], 1e-12);
    two.last_ = result.v;
  }
}

TEST(Renderer, DoesNotAllocate) {
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

// Tests the link pairs of one or two arms, and the messages for invalid pairs.
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
    return RobotModel::Load({a.model, "", a.remove_links, a.base.X_RB()});
  };
  std::array<std::shared_ptr<const RobotModel>, kHands> models = {load(*s.device.left), nullptr};
  EXPECT_TRUE(LinkPairs(s, models).empty());  // no second elbow to avoid

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

// If both links belong to the same arm, the damper slows their approach. The damper's row in the
// problem is the rate of change of the links' distance.
TEST(LinkDistance, OfOneArmIsTheRateOfItsOwnDistance) {
  Scenario s;
  s.device.left = Panda(0.25);
  s.left_handle = HandleSpec{};
  s.rendering.link_pairs = {{"left:panda_link2", "left:panda_link7"}};
  const ArmSpec& spec = s.arm(0);
  const auto model = RobotModel::Load({spec.model, "", spec.remove_links, spec.base.X_RB()});
  const RenderSetup setup(s, {model, nullptr}, 0, kDt);
  const std::array<const char*, 1> limits = {"link_distance"};
  Assembler assembler(setup, {}, limits);
  RandomStream random(5, "pair");
  JointVector q(7), v(7);
  for (int j = 0; j < 7; ++j) q[j] = -0.5 + random.Uniform(), v[j] = random.Normal();
  q[3] = -1.5;
  const auto evaluate = [&](const JointVector& at, Qp* qp) {
    RobotData data(*model);
    data.UpdateKinematics(*model, at, v);
    const RenderContext context(
        {RenderArm{true, model.get(), &data, &data, model->Frame("panda_link8"), &at}, RenderArm{}},
        {}, {v, v}, kDt);
    assembler.Update(context);
    assembler.Assemble(context, Precedence::kWeights, qp);
    RenderResult result;
    assembler.Publish(nullptr, &result);
    return result.link_distance;
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
