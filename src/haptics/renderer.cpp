#include "haptics/renderer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "haptics/limits.h"
#include "haptics/qp.h"
#include "haptics/tasks.h"

namespace predictor {
namespace {

constexpr int kFailuresBeforeStop = 3;       // ticks
constexpr double kKktTolerance = 1e-6;       // above it a solution is not believed
constexpr double kRelaxedSlack = 1e-5;       // [m/s], [rad/s]: above it a level counts as relaxed
constexpr double kLinkBraking = 2.0;         // with which a link pair can be braked [m/s²]

int JointsOf(const std::array<std::shared_ptr<const RobotModel>, kHands>& models) {
  int n = 0;
  for (const auto& m : models) n += m ? m->dof() : 0;
  return n;
}

std::array<JointLimits::Arm, kHands> ArmsOf(
    const Scenario& s, const std::array<std::shared_ptr<const RobotModel>, kHands>& models) {
  std::array<JointLimits::Arm, kHands> arms;
  for (int i = 0; i < kHands; ++i) {
    if (!models[i]) continue;
    const ArmLimits l = LimitsOf(s.arm(i), *models[i]);
    arms[i] = {l.lower, l.upper, l.velocity, l.acceleration};
  }
  return arms;
}

}  // namespace

ArmLimits LimitsOf(const ArmSpec& spec, const RobotModel& model) {
  constexpr double kShareOfVendor = 0.8;
  ArmLimits l;
  l.lower = model.position_lower();
  l.upper = model.position_upper();
  l.velocity = kShareOfVendor * model.velocity_limit();
  l.acceleration.resize(model.dof());
  for (int j = 0; j < model.dof(); ++j) {
    if (!spec.velocity_limit.empty())
      l.velocity[j] = std::min(l.velocity[j], OneOrEach(spec.velocity_limit, j));
    l.acceleration[j] = OneOrEach(spec.acceleration_limit, j);
  }
  return l;
}

struct Renderer::Impl {
  Impl(const Scenario& s, const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
       double lead, double tick)
      : safety(s.safety),
        dt(tick),
        joint_limits(s.rendering, ArmsOf(s, models)),
        links(s.rendering, kLinkBraking, LinkPairs(s, models)),
        tracking(s.rendering, lead, tick),
        relative(s.rendering),
        manipulability(s.rendering.manipulability),
        regularisation(s.rendering),
        joints(JointsOf(models)),
        qp(joints + links.rows(), links.rows()),
        solver(joints + links.rows(), links.rows()) {
    for (int i = 0; i < kHands; ++i)
      if (models[i]) acceleration[i] = LimitsOf(s.arm(i), *models[i]).acceleration;
  }

  void Assemble(const RenderState& state) noexcept;
  void SlowDown(const RenderState& state, RenderResult* result) const noexcept;
  bool SlackTooLarge(const Vector6& slack) const noexcept;

  SafetySpec safety;
  double dt;
  JointLimits joint_limits;
  LinkDistance links;
  Tracking tracking;
  RelativePose relative;
  Manipulability manipulability;
  Regularisation regularisation;
  int joints;
  Qp qp;
  QpSolver solver;
  QpSolution solution;
  std::array<JointVector, kHands> acceleration;  // [rad/s²]
  int failures = 0;
  double slack_time = 0;  // for which the relative slack has been too large [s]
};

Renderer::Renderer(const Scenario& scenario,
                   const std::array<std::shared_ptr<const RobotModel>, kHands>& models, double lead,
                   double dt)
    : impl_(std::make_unique<Impl>(scenario, models, lead, dt)) {}
Renderer::~Renderer() = default;
const Qp& Renderer::qp() const { return impl_->qp; }

void Renderer::Impl::Assemble(const RenderState& state) noexcept {
  qp.Clear();
  tracking.AddTo(state, &qp);
  relative.AddTo(state, &qp);
  manipulability.AddTo(state, &qp);
  regularisation.AddTo(state, &qp);
  joint_limits.AddTo(state, 0, &qp);
  links.AddTo(state, 0, &qp);
  // Each row has a slack variable; scaled so that its weight becomes 1.
  for (int r = 0; r < links.rows(); ++r) {
    qp.H()(joints + r, joints + r) = 1;
    qp.A()(r, joints + r) = 1 / std::sqrt(kLinkSlackWeight);
  }
}

// Without a solution: the last command, slowed by one common factor within the joints'
// accelerations, which keeps the handles' relative pose to first order.
void Renderer::Impl::SlowDown(const RenderState& state, RenderResult* result) const noexcept {
  double factor = 0;
  for (int i = 0; i < kHands; ++i)
    for (int j = 0; state.arms[i].present && j < state.last[i].size(); ++j)
      factor = std::max(factor, 1 - acceleration[i][j] * dt / std::max(1e-9, std::abs(state.last[i][j])));
  for (int i = 0; i < kHands; ++i)
    if (state.arms[i].present) result->v[i] = std::max(0.0, factor) * state.last[i];
}

bool Renderer::Impl::SlackTooLarge(const Vector6& slack) const noexcept {
  return slack.head<3>().norm() > safety.relative_slack ||
         slack.tail<3>().norm() > safety.relative_slack_rotation;
}

Status Renderer::Render(const std::array<RenderArm, kHands>& arms, const RenderTarget& target,
                        const std::array<JointVector, kHands>& last, RenderResult* result) noexcept {
  Impl& s = *impl_;
  std::array<Jacobian, kHands> J;
  std::array<Pose, kHands> X_WH;
  std::array<int, kHands> offset = {0, 0};
  for (int i = 0; i < kHands; ++i) {
    if (i > 0) offset[i] = offset[i - 1] + static_cast<int>(arms[i - 1].present ? arms[i - 1].q->size() : 0);
    if (!arms[i].present) continue;
    arms[i].ahead->FrameJacobian(*arms[i].model, arms[i].handle, &J[i]);
    X_WH[i] = arms[i].data->FramePose(*arms[i].model, arms[i].handle);
  }
  const RenderState state{arms, J, X_WH, offset, s.joints, target, last, s.dt};
  s.Assemble(state);
  s.solver.Solve(s.qp, &s.solution);
  result->kkt_residual = s.solution.solved ? KktResidual(s.qp, s.solution) : HUGE_VAL;
  result->iterations = s.solution.iterations;
  result->failed = !(result->kkt_residual <= kKktTolerance);
  result->elbow_distance = s.links.nearest();
  result->manipulability = s.manipulability.value();
  if (result->failed) {
    s.SlowDown(state, result);
    if (++s.failures >= kFailuresBeforeStop)
      return {StopCause::kQp, -1, static_cast<double>(s.failures), kFailuresBeforeStop - 1.0};
    return Status::Ok();
  }
  s.failures = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    result->v[i] = Eigen::Map<const Eigen::VectorXd>(s.solution.x.data() + offset[i], arms[i].q->size());
  }
  result->relative_slack = s.relative.Slack(state, s.solution.x.data());
  result->elbow_slack = 0;
  for (int r = 0; r < s.links.rows(); ++r)
    result->elbow_slack = std::max(result->elbow_slack, std::abs(s.solution.x[static_cast<std::size_t>(s.joints + r)]) /
                                                            std::sqrt(kLinkSlackWeight));
  result->relaxed = result->relative_slack.lpNorm<Eigen::Infinity>() > kRelaxedSlack ||
                    result->elbow_slack > kRelaxedSlack;
  s.slack_time = s.SlackTooLarge(result->relative_slack) ? s.slack_time + s.dt : 0;
  if (s.slack_time > s.safety.relative_slack_time)
    return {StopCause::kTracking, -1, result->relative_slack.head<3>().norm(), s.safety.relative_slack};
  return Status::Ok();
}

void Renderer::Reset() noexcept {
  impl_->failures = 0;
  impl_->slack_time = 0;
  impl_->tracking.Reset();
}

}  // namespace predictor
