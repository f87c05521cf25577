// The problem that the paper's formulation assembles must equal equations (3) to (15). The test
// writes these equations with matrices, as the paper does.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/random.h"
#include "haptics/assemble.h"
#include "haptics/link_pairs.h"
#include "haptics/registry.h"
#include "qp/qp.h"
#include "support/soak.h"
#include "two_arms.h"

namespace predictor {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Scenario PaperOf(Scenario scenario) {
  scenario.rendering.formulation = "paper";
  ApplyFormulation(&scenario);
  return scenario;
}

// Computes η_a ε_b − η_b ε_a − S(ε_b) ε_a of equation (9), where b is the desired orientation.
Vector3 OrientationError(const Quaternion& b, const Quaternion& a) {
  const Vector3 cross = Skew(b.vec()) * a.vec();
  return a.w() * b.vec() - b.w() * a.vec() - cross;
}

// Computes the speed at which a joint at this distance from a limit may approach the limit, by
// equations (14) and (15) [rad/s].
double JointDamper(double distance, double fastest) {
  constexpr double kXi = 1, kInfluence = 0.3, kSecurity = 0.02;
  if (distance > kInfluence) return fastest;
  return std::min(fastest, kXi * (distance - kSecurity) / (kInfluence - kSecurity));
}

struct PaperProblem {
  Matrix P, A, G;
  Vector c, b, h, lower, upper;
};

PaperProblem Write(const TwoArms& two) {
  std::array<Jacobian, kHands> J, elbow;
  std::array<Pose, kHands> H;
  std::array<Vector3, kHands> elbow_at;
  for (int i = 0; i < kHands; ++i) {
    const RenderArm& arm = two.arms_[i];
    arm.data->FrameJacobian(*arm.model, arm.handle, &J[i]);
    H[i] = arm.data->FramePose(*arm.model, arm.handle);
    const FrameId frame = arm.model->Frame("panda_link4");
    arm.data->FrameJacobian(*arm.model, frame, &elbow[i]);
    elbow_at[i] = arm.data->FramePose(*arm.model, frame).p;
  }
  const auto& D = two.target_.handle;
  Matrix all = Matrix::Zero(12, 14);
  Vector rate(12);
  for (int i = 0; i < kHands; ++i) {
    all.block(6 * i, 7 * i, 6, 7) = J[i];
    rate.segment<3>(6 * i) = D[i].V_W.head<3>() + 2.0 * (D[i].X_W.p - H[i].p);
    rate.segment<3>(6 * i + 3) = D[i].V_W.tail<3>() + 0.4 * OrientationError(D[i].X_W.q, H[i].q);
  }
  PaperProblem paper;
  // The regularisation ε keeps the problem strictly convex, because the paper's P has rank 12 of
  // 14.
  paper.P = all.transpose() * all + 1e-5 * Matrix::Identity(14, 14);
  paper.c = -all.transpose() * rate;
  const Vector3 p = H[1].p - H[0].p;
  paper.A = Matrix::Zero(6, 14);
  paper.A.block(0, 0, 3, 7) = J[0].topRows<3>() + Skew(p).transpose() * J[0].bottomRows<3>();
  paper.A.block(0, 7, 3, 7) = -J[1].topRows<3>();
  paper.A.block(3, 0, 3, 7) = J[0].bottomRows<3>();
  paper.A.block(3, 7, 3, 7) = -J[1].bottomRows<3>();
  paper.b.resize(6);
  paper.b.head<3>() = -1.0 * ((D[1].X_W.p - D[0].X_W.p) - p);
  paper.b.tail<3>() = -0.9 * OrientationError(H[0].q, H[1].q);
  const Vector3 between = elbow_at[0] - elbow_at[1];
  const double d = between.norm();
  const Vector3 n = between / d;
  paper.G = Matrix::Zero(1, 14);
  paper.G.block(0, 0, 1, 7) = -n.transpose() * elbow[0].topRows<3>();
  paper.G.block(0, 7, 1, 7) = n.transpose() * elbow[1].topRows<3>();
  paper.h.resize(1);
  paper.h[0] = d < 0.7 ? 1.0 * (d - 0.3) / (0.7 - 0.3) : 1e30;
  paper.lower.resize(14);
  paper.upper.resize(14);
  for (int i = 0; i < kHands; ++i)
    for (int j = 0; j < 7; ++j) {
      const double fastest = two.models_[i]->velocity_limit()[j];
      const double q = two.q_[i][j];
      paper.upper[7 * i + j] = JointDamper(two.limits_[i].upper[j] - q, fastest);
      paper.lower[7 * i + j] = -JointDamper(q - two.limits_[i].lower[j], fastest);
    }
  return paper;
}

class PaperFormulation : public testing::Test {
 protected:
  PaperFormulation()
      : scenario_(PaperOf(two_.scenario_)), setup_(scenario_, two_.models_, 0, kDt) {}

  const Qp& Assemble(Assembler* assembler, Qp* qp) {
    const RenderContext context(two_.arms_, two_.target_, two_.last_, kDt);
    assembler->Update(context);
    assembler->Assemble(context, Precedence::kHard, qp);
    return *qp;
  }

  TwoArms two_;
  Scenario scenario_;
  RenderSetup setup_;
};

TEST_F(PaperFormulation, EqualsTheEquations) {
  Assembler assembler(setup_);
  ASSERT_FALSE(assembler.is_soft());
  RandomStream random(41, "the paper's equations");
  bool pushed_apart = false, far = false;
  for (int k = 0; k < 2000; ++k) {
    two_.Draw(&random);
    Qp made = assembler.MakeQp(Precedence::kHard);
    const Qp& qp = Assemble(&assembler, &made);
    const PaperProblem paper = Write(two_);
    ASSERT_EQ(qp.n(), 14);
    ASSERT_EQ(qp.m(), 7);
    ASSERT_LT((Matrix(qp.H()) - paper.P).lpNorm<Eigen::Infinity>(), 1e-12);
    ASSERT_LT((Vector(qp.f()) - paper.c).lpNorm<Eigen::Infinity>(), 1e-12);
    // The first row of the QP corresponds to the paper's G x ≤ h, written as −G x ≥ −h.
    ASSERT_LT((Matrix(qp.A()).row(0) + paper.G).lpNorm<Eigen::Infinity>(), 1e-12);
    if (paper.h[0] < 1e29)
      ASSERT_NEAR(qp.b()[0], -paper.h[0], 1e-12);
    else
      ASSERT_LE(qp.b()[0], -1e29);
    ASSERT_LT((Matrix(qp.A()).bottomRows(6) - paper.A).lpNorm<Eigen::Infinity>(), 1e-12);
    ASSERT_LT((Vector(qp.b()).tail(6) - paper.b).lpNorm<Eigen::Infinity>(), 1e-12);
    ASSERT_EQ(Vector(qp.b()).tail(6), Vector(qp.b_upper()).tail(6));
    ASSERT_LT((Vector(qp.lower()) - paper.lower).lpNorm<Eigen::Infinity>(), 1e-12);
    ASSERT_LT((Vector(qp.upper()) - paper.upper).lpNorm<Eigen::Infinity>(), 1e-12);
    pushed_apart = pushed_apart || paper.h[0] < 0;
    far = far || paper.h[0] > 1e29;
  }
  // In some states, the distance between the elbows is less than d_s, and in other states, it is
  // more than d_i.
  EXPECT_TRUE(pushed_apart);
  EXPECT_TRUE(far);
}

// Hard rows may contradict each other. With slacks, a solution always exists
// (Renderer.HasAVerifiedSolutionEverywhereSoak draws the same kinds of states).
TEST_F(PaperFormulation, HasNoSolutionInSomeStates) {
  scenario_.safety.relative_slack = scenario_.safety.relative_slack_rotation = 1e9;
  Renderer renderer(scenario_, two_.models_, 0, kDt);
  RandomStream random(42, "the paper's failures");
  RenderResult result;
  int failed = 0;
  const int states = 2000;
  for (int k = 0; k < states; ++k) {
    two_.Draw(&random);
    renderer.Reset();
    EXPECT_TRUE(renderer.Render(two_.arms_, two_.target_, two_.last_, &result).ok());
    failed += result.failed;
  }
  RecordProperty("failed_share", std::to_string(static_cast<double>(failed) / states));
  EXPECT_GT(failed, 0);
  EXPECT_LT(failed, states);
}

// The paper's formulation with all repairs must be the same problem as our formulation.
TEST_F(PaperFormulation, WithAllRepairsIsOurs) {
  Scenario repaired = two_.scenario_;
  repaired.rendering.formulation = "paper";
  repaired.rendering.formulation_except = RepairNames();
  ASSERT_TRUE(RepairsOf(repaired.rendering).HasAll());
  const RenderSetup ours(two_.scenario_, two_.models_, 0.02, kDt);
  const RenderSetup same(repaired, two_.models_, 0.02, kDt);
  Assembler a(ours), b(same);
  RandomStream random(43, "all repairs");
  for (int k = 0; k < 100; ++k) {
    two_.Draw(&random);
    const RenderContext context(two_.arms_, two_.target_, two_.last_, kDt);
    Qp qp_a = a.MakeQp(Precedence::kWeights), qp_b = b.MakeQp(Precedence::kWeights);
    a.Update(context);
    b.Update(context);
    a.Assemble(context, Precedence::kWeights, &qp_a);
    b.Assemble(context, Precedence::kWeights, &qp_b);
    ASSERT_EQ(Matrix(qp_a.H()), Matrix(qp_b.H()));
    ASSERT_EQ(Vector(qp_a.f()), Vector(qp_b.f()));
    ASSERT_EQ(Vector(qp_a.b()), Vector(qp_b.b()));
    ASSERT_EQ(Vector(qp_a.lower()), Vector(qp_b.lower()));
  }
}

TEST_F(PaperFormulation, HasNeitherLeadNorCoupling) {
  EXPECT_EQ(scenario_.rendering.lead, 0);
  EXPECT_EQ(scenario_.coupling.stiffness, 0);
  EXPECT_EQ(scenario_.coupling.rotation_damping, 0);
  Scenario with = two_.scenario_;
  with.rendering.formulation = "paper";
  with.rendering.formulation_except = {"lead", "coupling"};
  ApplyFormulation(&with);
  EXPECT_FALSE(with.rendering.lead.has_value());  // auto
  EXPECT_EQ(with.coupling.stiffness, CouplingSpec().stiffness);
}

}  // namespace
}  // namespace predictor
