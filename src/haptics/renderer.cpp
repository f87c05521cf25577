#include "haptics/renderer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/motion.h"
#include "haptics/limits.h"
#include "haptics/qp.h"
#include "haptics/tasks.h"

namespace predictor {
namespace {

constexpr int kFailuresBeforeStop = 3;  // ticks
constexpr double kKktTolerance = 1e-6;  // above it a solution is not believed
static_assert(kMaxArmJoints <= 16 && kMaxLimitRows <= 16, "bits of RenderResult");
constexpr double kRelaxedSlack = 1e-5;  // [m/s], [rad/s]: above it a level counts as relaxed

int JointsOf(const std::array<std::shared_ptr<const RobotModel>, kHands>& models) {
  int n = 0;
  for (const auto& m : models) n += m ? m->dof() : 0;
  return n;
}

int RowsOf(const std::vector<std::unique_ptr<Limit>>& limits) {
  int rows = 0;
  for (const auto& limit : limits) rows += limit->rows();
  if (rows > kMaxLimitRows)
    throw InputError("The limits need " + std::to_string(rows) + " rows; at most " +
                     std::to_string(kMaxLimitRows) + " fit. Remove some of rendering.link_pairs.");
  return rows;
}

}  // namespace

struct Renderer::Impl {
  Impl(const Scenario& s, const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
       double lead, double tick)
      : safety(s.safety),
        dt(tick),
        limits(MakeLimits(s, models)),
        rows(RowsOf(limits.all)),
        tracking(s.rendering, lead, tick),
        relative(s.rendering),
        manipulability(s.rendering.manipulability),
        regularisation(s.rendering),
        joints(JointsOf(models)),
        qp(joints + rows, rows),
        qp_rows(joints + rows + 6, rows + 6),
        solver(qp.n(), qp.m()),
        solver_rows(qp_rows.n(), qp_rows.m()) {}

  void Assemble(const RenderState& state) noexcept;
  void AssembleRows(const RenderState& state) noexcept;
  void AddCommon(const RenderState& state, Qp* problem) noexcept;
  void Solve(const RenderState& state, RenderResult* result) noexcept;
  void SlowDown(const RenderState& state, RenderResult* result) const noexcept;
  void TellActive(const RenderState& state, const Qp& solved, RenderResult* result) const noexcept;
  Status CheckSlack(const Vector6& slack) noexcept;

  SafetySpec safety;
  double dt;
  Limits limits;
  int rows;  // of all limits
  Tracking tracking;
  RelativePose relative;
  Manipulability manipulability;
  Regularisation regularisation;
  int joints;
  Qp qp;       // with the relative pose by weight
  Qp qp_rows;  // with the relative pose as rows, where the former cannot be solved precisely
  QpSolver solver, solver_rows;
  QpSolution solution;
  int failures = 0;
  double slack_time = 0;  // for which the relative slack has been too large [s]
};

Renderer::Renderer(const Scenario& scenario,
                   const std::array<std::shared_ptr<const RobotModel>, kHands>& models, double lead,
                   double dt)
    : impl_(std::make_unique<Impl>(scenario, models, lead, dt)) {}
Renderer::~Renderer() = default;
const Qp& Renderer::qp() const { return impl_->qp; }

void Renderer::Impl::AddCommon(const RenderState& state, Qp* problem) noexcept {
  tracking.AddTo(state, problem);
  manipulability.AddTo(state, problem);
  regularisation.AddTo(state, problem);
  int row = 0;
  for (const auto& limit : limits.all) {
    limit->AddTo(state, row, problem);
    row += limit->rows();
  }
  // Each row has a slack variable; scaled so that its weight becomes 1.
  for (int r = 0; r < rows; ++r) {
    problem->H()(joints + r, joints + r) = 1;
    problem->A()(r, joints + r) = 1 / std::sqrt(kLimitSlackWeight);
  }
}

void Renderer::Impl::Assemble(const RenderState& state) noexcept {
  qp.Clear();
  AddCommon(state, &qp);
  relative.AddTo(state, &qp);
}

void Renderer::Impl::AssembleRows(const RenderState& state) noexcept {
  qp_rows.Clear();
  AddCommon(state, &qp_rows);
  relative.AddRowsTo(state, rows, joints + rows, &qp_rows);
}

// The two problems have the same solution. By weight it is found in half the time, but with many
// joints at their limits a condition of 1e10 may leave the solver without an answer; then the rows
// are solved, at last with joints damped as at a singularity. None is believed without proof.
void Renderer::Impl::Solve(const RenderState& state, RenderResult* result) noexcept {
  Assemble(state);
  solver.Solve(qp, &solution);
  result->iterations = solution.iterations;
  result->kkt_residual = KktResidual(qp, solution);
  const Qp* solved = &qp;
  for (int attempt = 0; attempt < 3 && !(result->kkt_residual <= kKktTolerance); ++attempt) {
    AssembleRows(state);
    if (attempt > 0) qp_rows.H().diagonal().head(joints).array() += attempt * kDamping;
    solver_rows.Solve(qp_rows, &solution);
    result->iterations += solution.iterations;
    result->kkt_residual = KktResidual(qp_rows, solution);
    solved = &qp_rows;
  }
  result->failed = !(result->kkt_residual <= kKktTolerance);
  TellActive(state, *solved, result);
}

void Renderer::Impl::TellActive(const RenderState& state, const Qp& solved,
                                RenderResult* result) const noexcept {
  result->at_lower = result->at_upper = {};
  result->rows = 0;
  if (result->failed) return;
  const auto bit = [](int k) { return static_cast<std::uint16_t>(1U << static_cast<unsigned>(k)); };
  const auto multiplier = [&](int k) { return solution.multiplier[static_cast<std::size_t>(k)]; };
  for (int i = 0; i < kHands; ++i)
    for (int j = 0; state.arms[i].present && j < state.arms[i].q->size(); ++j) {
      const double m = multiplier(state.offset[i] + j);
      if (m < 0) result->at_lower[i] |= bit(j);
      if (m > 0) result->at_upper[i] |= bit(j);
    }
  for (int r = 0; r < rows; ++r)
    if (multiplier(solved.n() + r) != 0) result->rows |= bit(r);
}

// Without a solution: the last command, slowed by one common factor, which keeps the handles'
// relative pose to first order, as a stop of the faster handle begins. Braking harder at once would
// be a jerk that the stop, if it comes to one, could not undo.
void Renderer::Impl::SlowDown(const RenderState& state, RenderResult* result) const noexcept {
  double speed = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!state.arms[i].present) continue;
    Twist V = Twist::Zero();
    for (int j = 0; j < state.last[i].size(); ++j) V += state.J[i].col(j) * state.last[i][j];
    speed = std::max(speed, StopSpeed(V));
  }
  double factor = 1 - safety.stop_jerk * (failures + 1) * dt * dt / std::max(1e-9, speed);
  for (int i = 0; i < kHands; ++i)
    for (int j = 0; state.arms[i].present && j < state.last[i].size(); ++j)
      factor = std::max(factor, 1 - limits.joints->acceleration(i, j) * dt /
                                        std::max(1e-9, std::abs(state.last[i][j])));
  for (int i = 0; i < kHands; ++i)
    if (state.arms[i].present) result->v[i] = std::max(0.0, factor) * state.last[i];
}

// Whether the relative pose has yielded for too long, by translation or by rotation.
Status Renderer::Impl::CheckSlack(const Vector6& slack) noexcept {
  const double speed = slack.head<3>().norm();
  const double rotation = slack.tail<3>().norm();
  const bool translates = speed > safety.relative_slack;
  const bool rotates = rotation > safety.relative_slack_rotation;
  slack_time = translates || rotates ? slack_time + dt : 0;
  if (slack_time <= safety.relative_slack_time) return Status::Ok();
  if (translates) return {StopCause::kTracking, -1, speed, safety.relative_slack, Quantity::kSpeed};
  return {StopCause::kTracking, -1, rotation, safety.relative_slack_rotation,
          Quantity::kAngularSpeed};
}

Status Renderer::Render(const std::array<RenderArm, kHands>& arms, const RenderTarget& target,
                        const std::array<JointVector, kHands>& last,
                        RenderResult* result) noexcept {
  Impl& s = *impl_;
  std::array<Jacobian, kHands> J;
  std::array<Pose, kHands> X_WH, X_WH_ahead;
  std::array<int, kHands> offset = {0, 0};
  for (int i = 0; i < kHands; ++i) {
    if (i > 0)
      offset[i] = offset[i - 1] + static_cast<int>(arms[i - 1].present ? arms[i - 1].q->size() : 0);
    if (!arms[i].present) continue;
    arms[i].ahead->FrameJacobian(*arms[i].model, arms[i].handle, &J[i]);
    X_WH[i] = arms[i].data->FramePose(*arms[i].model, arms[i].handle);
    X_WH_ahead[i] = arms[i].ahead->FramePose(*arms[i].model, arms[i].handle);
  }
  const RenderState state{arms, J, X_WH, X_WH_ahead, offset, s.joints, target, last, s.dt};
  if (!target.aligning) s.tracking.Advance(target);
  s.Solve(state, result);
  result->elbow_distance = s.limits.links->nearest();
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
    // Within the solver's tolerance a bound may be passed; not in what is sent.
    result->v[i].resize(arms[i].q->size());
    for (int j = 0; j < result->v[i].size(); ++j) {
      const int k = offset[i] + j;
      result->v[i][j] =
          std::clamp(s.solution.x[static_cast<std::size_t>(k)], s.qp.lower()[k], s.qp.upper()[k]);
    }
  }
  result->relative_slack = s.relative.Slack(state, s.solution.x.data());
  result->elbow_slack = 0;
  for (int r = 0; r < s.rows; ++r)
    result->elbow_slack = std::max(result->elbow_slack,
                                   std::abs(s.solution.x[static_cast<std::size_t>(s.joints + r)]) /
                                       std::sqrt(kLimitSlackWeight));
  result->relaxed = result->relative_slack.lpNorm<Eigen::Infinity>() > kRelaxedSlack ||
                    result->elbow_slack > kRelaxedSlack;
  return s.CheckSlack(result->relative_slack);
}

// The solver begins each problem from scratch.
void Renderer::Archive(StateArchive& a) noexcept {
  a(impl_->failures, impl_->slack_time, impl_->tracking);
}

void Renderer::Reset() noexcept {
  impl_->failures = 0;
  impl_->slack_time = 0;
  impl_->tracking.Reset();
}

}  // namespace predictor
