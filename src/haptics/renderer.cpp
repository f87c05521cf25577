#include "haptics/renderer.h"

#include <algorithm>
#include <cmath>

#include "core/motion.h"
#include "haptics/assemble.h"

namespace predictor {
namespace {

constexpr int kMaxFailures = 3;         // consecutive ticks without a solution
constexpr double kKktTolerance = 1e-6;  // largest residual of an accepted solution
constexpr double kRelaxedSlack = 1e-5;  // [m/s], [rad/s]: a level with more slack counts as relaxed

}  // namespace

struct Renderer::Impl {
  explicit Impl(const RenderSetup& setup)
      : safety(setup.scenario.safety),
        limits(setup.limits),
        dt(setup.dt),
        assembler(setup),
        form(assembler.is_soft() ? Precedence::kWeights : Precedence::kHard),
        qp(assembler.MakeQp(form)),
        qp_rows(assembler.MakeQp(Precedence::kRows)),
        solver(qp.n(), qp.m()),
        solver_rows(qp_rows.n(), qp_rows.m()) {}

  void Solve(RenderResult* result) noexcept;
  void PublishActive(const Qp& solved, RenderResult* result) const noexcept;
  void PublishCommand(RenderResult* result) const noexcept;
  void SlowDown(RenderResult* result) const noexcept;
  Status CheckSlack(const Vector6& slack) noexcept;

  SafetySpec safety;
  std::array<ArmLimits, kHands> limits;
  double dt;  // [s]
  Assembler assembler;
  Precedence form;  // tried first; kHard is tried alone
  Qp qp;
  Qp qp_rows;  // used if the weighted form cannot be solved precisely
  QpSolver solver, solver_rows;
  RenderContext context;
  QpSolution solution;
  int failures = 0;
  double slack_time = 0;  // time for which the relative slack has been too large [s]
};

Renderer::Renderer(const Scenario& scenario,
                   const std::array<std::shared_ptr<const RobotModel>, kHands>& models, double lead,
                   double dt)
    : impl_(std::make_unique<Impl>(RenderSetup(scenario, models, lead, dt))) {}
Renderer::~Renderer() = default;
const Qp& Renderer::qp() const { return impl_->qp; }
const Assembler& Renderer::assembler() const { return impl_->assembler; }

// Solving the weighted form takes half the time. If many joints are at their limits, however, a
// condition number of 1e10 may prevent the solver from finding a solution. In this case, the form
// with rows is solved. If this fails, the form with rows is solved again, with the joint damping
// that is used at a singularity. The renderer accepts only a verified solution. The paper's
// formulation has only one form.
void Renderer::Impl::Solve(RenderResult* result) noexcept {
  assembler.Update(context);
  assembler.Assemble(context, form, &qp);
  solver.Solve(qp, &solution);
  result->iterations = solution.iterations;
  result->kkt_residual = KktResidual(qp, solution);
  const Qp* solved = &qp;
  const int retries = assembler.is_soft() ? 3 : 0;
  for (int attempt = 0; attempt < retries && !(result->kkt_residual <= kKktTolerance); ++attempt) {
    assembler.Assemble(context, Precedence::kRows, &qp_rows);
    if (attempt > 0)
      qp_rows.H().diagonal().head(context.joints).array() += attempt * kSingularDamping;
    solver_rows.Solve(qp_rows, &solution);
    result->iterations += solution.iterations;
    result->kkt_residual = KktResidual(qp_rows, solution);
    solved = &qp_rows;
  }
  result->failed = !(result->kkt_residual <= kKktTolerance);
  PublishActive(*solved, result);
}

void Renderer::Impl::PublishActive(const Qp& solved, RenderResult* result) const noexcept {
  result->at_lower = result->at_upper = {};
  result->rows = 0;
  if (result->failed) return;
  const auto bit = [](int k) { return static_cast<std::uint16_t>(1U << static_cast<unsigned>(k)); };
  const auto multiplier = [&](int k) { return solution.multiplier[static_cast<std::size_t>(k)]; };
  for (int i = 0; i < kHands; ++i)
    for (int j = 0; context.Has(i) && j < context.arms[i].q->size(); ++j) {
      const double m = multiplier(context.offset[i] + j);
      if (m < 0) result->at_lower[i] |= bit(j);
      if (m > 0) result->at_upper[i] |= bit(j);
    }
  for (int r = 0; r < assembler.limit_rows(); ++r)
    if (multiplier(solved.n() + r) != 0) result->rows |= bit(r);
}

// The solution may violate a bound within the solver's tolerance, but the command must not violate
// any bound.
void Renderer::Impl::PublishCommand(RenderResult* result) const noexcept {
  for (int i = 0; i < kHands; ++i) {
    if (!context.Has(i)) continue;
    result->v[i].resize(context.arms[i].q->size());
    for (int j = 0; j < result->v[i].size(); ++j) {
      const int k = context.offset[i] + j;
      result->v[i][j] =
          std::clamp(solution.x[static_cast<std::size_t>(k)], qp.lower()[k], qp.upper()[k]);
    }
  }
}

// If there is no solution, this function multiplies the last command by a common factor, so that
// the faster handle slows down as at the beginning of a stop. Because of the common factor, the
// relative pose of the handles is constant to first order. Stronger braking would cause a jerk that
// a subsequent stop could not undo.
void Renderer::Impl::SlowDown(RenderResult* result) const noexcept {
  double speed = 0;
  for (int i = 0; i < kHands; ++i)
    if (context.Has(i))
      speed = std::max(speed, StopSpeed(context.J[i].lazyProduct(context.last[i])));
  double factor = 1 - safety.stop_jerk * (failures + 1) * dt * dt / std::max(1e-9, speed);
  for (int i = 0; i < kHands; ++i)
    for (int j = 0; context.Has(i) && j < context.last[i].size(); ++j)
      factor = std::max(factor, 1 - limits[i].acceleration[j] * dt /
                                        std::max(1e-9, std::abs(context.last[i][j])));
  for (int i = 0; i < kHands; ++i)
    if (context.Has(i)) result->v[i] = std::max(0.0, factor) * context.last[i];
}

// Checks whether the relative pose has had slack, in translation or in rotation, for too long.
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
  s.context = RenderContext(arms, target, last, s.dt);
  s.Solve(result);
  s.assembler.Publish(result->failed ? nullptr : s.solution.x.data(), result);
  if (result->failed) {
    s.SlowDown(result);
    if (++s.failures >= kMaxFailures)
      return {StopCause::kQp, -1, static_cast<double>(s.failures), kMaxFailures - 1.0};
    return Status::Ok();
  }
  s.failures = 0;
  s.PublishCommand(result);
  result->relaxed = result->relative_slack.lpNorm<Eigen::Infinity>() > kRelaxedSlack ||
                    result->limit_slack > kRelaxedSlack;
  return s.CheckSlack(result->relative_slack);
}

// The solver's state need not be saved, because the solver solves each problem from scratch.
void Renderer::Archive(StateArchive& a) noexcept {
  a(impl_->failures, impl_->slack_time, impl_->assembler);
}

void Renderer::Reset() noexcept {
  impl_->failures = 0;
  impl_->slack_time = 0;
  impl_->assembler.Reset();
}

}  // namespace predictor
