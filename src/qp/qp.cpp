#include "qp/qp.h"

#include <algorithm>
#include <cmath>

extern "C" {
#include "api.h"
#include "utils.h"
}

namespace predictor {

void Qp::Clear() noexcept {
  std::fill_n(h_.begin(), n_ * n_, 0.0);
  std::fill_n(f_.begin(), n_, 0.0);
  std::fill_n(a_.begin(), m_ * n_, 0.0);
  std::fill_n(lower_.begin(), n_ + m_, -DAQP_INF);
  std::fill_n(upper_.begin(), n_ + m_, DAQP_INF);
}

double KktResidual(const Qp& qp, const QpSolution& solution) noexcept {
  if (!solution.solved) return HUGE_VAL;
  const int n = qp.n();
  const int m = qp.m();
  const double* x = solution.x.data();
  const double* y = solution.multiplier.data();
  const auto H = qp.H();
  const auto A = qp.A();
  double scale = std::max(1.0, qp.f().lpNorm<Eigen::Infinity>());
  for (int k = 0; k < n + m; ++k) scale = std::max(scale, std::abs(y[k]));
  // H is symmetric, so its rows are equal to its columns, and the sums for all elements are
  // computed together.
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxQpVariables> gradient(n);
  for (int i = 0; i < n; ++i) gradient[i] = qp.f()[i] + y[i];
  for (int j = 0; j < n; ++j) gradient += x[j] * H.row(j);
  for (int r = 0; r < m; ++r) gradient += y[n + r] * A.row(r);
  double residual = 0;
  double sum = 0;  // sum of all values: not finite if any of them is not finite (a maximum would
                   // miss NaN)
  for (int i = 0; i < n; ++i) {
    residual = std::max(residual, std::abs(gradient[i]) / scale);
    sum += gradient[i] + x[i];
  }
  for (int k = 0; k < n + m; ++k) {
    double value = 0;
    double upper = DAQP_INF;
    double lower = 0;
    if (k < n) {
      value = x[k];
      lower = qp.lower()[k];
      upper = qp.upper()[k];
    } else {
      for (int j = 0; j < n; ++j) value += A(k - n, j) * x[j];
      lower = qp.b()[k - n];
      upper = qp.b_upper()[k - n];
    }
    residual = std::max({residual, lower - value, value - upper});
    // A multiplier must have the sign that pushes away from its bound, and it may be nonzero only
    // if the bound is active.
    sum += y[k];
    const double push = std::abs(y[k]) / scale;
    const double gap = y[k] > 0 ? upper - value : value - lower;
    residual = std::max(residual, std::min(push, std::abs(gap)));
  }
  return std::isfinite(sum) ? residual : HUGE_VAL;
}

struct QpSolver::Impl {
  Impl(int variables, int rows) : problem(variables, rows) {
    // The setup solves no problem. The setup only allocates the memory for problems of this size
    // and with these types of constraint.
    problem.H().setIdentity();
    if (variables > 1)
      // Without a nonzero element off the diagonal, the solver would assume a diagonal matrix.
      problem.H()(0, 1) = problem.H()(1, 0) = 0.5;
    sense.fill(0);
    Point();
    daqp_default_settings(&settings);
    settings.primal_tol = 1e-9;
    // Widely differing weights make active bounds nearly parallel in the solver's metric. With the
    // default tolerance, the solver treats these bounds as dependent and wrongly reports the
    // problem as infeasible.
    settings.sing_tol = 1e-14;
    settings.iter_limit = 300;
    settings.eq_reduction = DAQP_EQ_REDUCTION_OFF;
    work.settings = &settings;
    setup_daqp_main(&daqp, &work, nullptr, 0);
    result.x = x.data();
    result.lam = lam.data();
  }
  ~Impl() {
    work.settings = nullptr;
    free_daqp_workspace(&work);
    free_daqp_ldp(&work);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  // Copies only the numbers in use, because the arrays have room for the largest problem.
  void Load(const Qp& qp) noexcept {
    const int n = qp.n(), m = qp.m();
    std::copy_n(qp.H().data(), n * n, problem.H().data());
    std::copy_n(qp.f().data(), n, problem.f().data());
    std::copy_n(qp.A().data(), m * n, problem.A().data());
    std::copy_n(qp.lower().data(), n + m, problem.lower().data());
    std::copy_n(qp.upper().data(), n + m, problem.upper().data());
  }

  void Point() {
    daqp.n = problem.n();
    daqp.m = problem.n() + problem.m();
    daqp.ms = problem.n();
    daqp.H = problem.H().data();
    daqp.f = problem.f().data();
    daqp.A = problem.A().data();
    daqp.bupper = problem.upper().data();
    daqp.blower = problem.lower().data();
    daqp.sense = sense.data();
  }

  Qp problem;  // a copy, because the solver requires mutable arrays
  DAQPProblem daqp{};
  DAQPWorkspace work{};
  DAQPSettings settings{};
  DAQPResult result{};
  std::array<int, kMaxQpVariables + kMaxQpRows> sense;
  std::array<double, kMaxQpVariables> x;
  std::array<double, kMaxQpVariables + kMaxQpRows> lam;
};

QpSolver::QpSolver(int variables, int rows) : impl_(std::make_unique<Impl>(variables, rows)) {}
QpSolver::~QpSolver() = default;

void QpSolver::Solve(const Qp& qp, QpSolution* solution) noexcept {
  Impl& s = *impl_;
  s.Load(qp);
  s.sense.fill(0);
  constexpr int kAll = DAQP_UPDATE_Rinv | DAQP_UPDATE_M | DAQP_UPDATE_v | DAQP_UPDATE_d |
                       DAQP_UPDATE_sense | DAQP_UPDATE_unconstrained;
  reset_daqp_workspace(
      &s.work);  // otherwise the solver would start from the final state of the previous problem
  solution->solved = false;
  solution->iterations = 0;
  if (daqp_update_ldp(kAll, &s.work, &s.daqp) < 0) return;
  daqp_solve(&s.result, &s.work);
  solution->iterations = s.work.iterations;
  if (s.result.exitflag <= 0) return;
  std::copy_n(s.x.begin(), qp.n(), solution->x.begin());
  std::copy_n(s.lam.begin(), qp.n() + qp.m(), solution->multiplier.begin());
  solution->solved = true;
}

}  // namespace predictor
