#include "qp_candidates.h"

#include <cmath>

extern "C" {
#include "api.h"
#include "utils.h"
}

namespace predictor::bench {
namespace {

// The solver that the program uses.
class Ours final : public Candidate {
 public:
  explicit Ours(const Problem& example) : solver_(example.weighed.n(), example.weighed.m()) {}
  std::string name() const override { return "DAQP (in use)"; }
  bool hard() const override { return false; }
  void Solve(const Problem& problem, Answer* answer) override {
    solver_.Solve(problem.weighed, &answer->solution);
  }

 private:
  QpSolver solver_;
};

// The solver DAQP, which receives the equality rows before the other rows.
class HardDaqp final : public Candidate {
 public:
  explicit HardDaqp(const Problem& example)
      : n_(example.hard.n()),
        m_(example.hard.m()),
        H_(n_, n_),
        A_(6 + m_, n_),
        f_(n_),
        lower_(n_ + 6 + m_),
        upper_(lower_.size()),
        sense_(static_cast<std::size_t>(lower_.size())) {
    Load(example);
    daqp_default_settings(&settings_);
    settings_.primal_tol = 1e-9;
    settings_.sing_tol = 1e-14;
    settings_.iter_limit = 300;
    settings_.eq_reduction = DAQP_EQ_REDUCTION_OFF;
    work_.settings = &settings_;
    setup_daqp_main(&daqp_, &work_, nullptr, 0);
    x_.resize(n_);
    lam_.resize(n_ + 6 + m_);
    result_.x = x_.data();
    result_.lam = lam_.data();
  }
  ~HardDaqp() override {
    work_.settings = nullptr;
    free_daqp_workspace(&work_);
    free_daqp_ldp(&work_);
  }
  HardDaqp(const HardDaqp&) = delete;
  HardDaqp& operator=(const HardDaqp&) = delete;
  std::string name() const override { return "DAQP"; }
  bool hard() const override { return true; }

  void Solve(const Problem& problem, Answer* answer) override {
    Load(problem);
    constexpr int kAll = DAQP_UPDATE_Rinv | DAQP_UPDATE_M | DAQP_UPDATE_v | DAQP_UPDATE_d |
                         DAQP_UPDATE_sense | DAQP_UPDATE_unconstrained;
    reset_daqp_workspace(&work_);
    answer->solution.solved = daqp_update_ldp(kAll, &work_, &daqp_) >= 0;
    if (!answer->solution.solved) return;
    daqp_solve(&result_, &work_);
    answer->solution.solved = result_.exitflag > 0;
    std::copy_n(x_.data(), n_, answer->solution.x.begin());
    std::copy_n(lam_.data(), n_, answer->solution.multiplier.begin());
    answer->equality = lam_.segment<6>(n_);
    std::copy_n(lam_.data() + n_ + 6, m_, answer->solution.multiplier.begin() + n_);
  }

 private:
  void Load(const Problem& problem) {
    const Qp& qp = problem.hard;
    H_ = qp.H();
    f_ = qp.f();
    A_ << problem.E, qp.A();
    lower_ << qp.lower(), problem.e, qp.b();
    upper_ << qp.upper(), problem.e, Eigen::VectorXd::Constant(m_, DAQP_INF);
    std::fill(sense_.begin(), sense_.end(), 0);
    std::fill_n(sense_.begin() + n_, 6, DAQP_ACTIVE | DAQP_IMMUTABLE);
    daqp_.n = n_;
    daqp_.m = n_ + 6 + m_;
    daqp_.ms = n_;
    daqp_.H = H_.data();
    daqp_.f = f_.data();
    daqp_.A = A_.data();
    daqp_.bupper = upper_.data();
    daqp_.blower = lower_.data();
    daqp_.sense = sense_.data();
  }

  int n_, m_;
  Qp::RowMajor H_, A_;
  Eigen::VectorXd f_, lower_, upper_, x_, lam_;
  std::vector<int> sense_;
  DAQPProblem daqp_{};
  DAQPWorkspace work_{};
  DAQPSettings settings_{};
  DAQPResult result_{};
};

}  // namespace

std::unique_ptr<Candidate> MakeDaqp(const Problem& example, bool hard) {
  if (hard) return std::make_unique<HardDaqp>(example);
  return std::make_unique<Ours>(example);
}

std::vector<std::unique_ptr<Candidate>> MakeCandidates(const Problem& example) {
  std::vector<std::unique_ptr<Candidate>> candidates;
  for (const bool hard : {false, true}) {
    candidates.push_back(MakeDaqp(example, hard));
    candidates.push_back(MakeEiquadprogFast(example, hard));
    if (!hard) {
      if (auto rt = MakeEiquadprogRt(example)) candidates.push_back(std::move(rt));
    }
    for (const bool warm : {false, true}) candidates.push_back(MakeProxQp(example, hard, warm));
  }
  return candidates;
}

double Residual(const Problem& problem, bool hard, const Answer& answer) {
  if (!answer.solution.solved) return HUGE_VAL;
  if (!hard) return KktResidual(problem.weighed, answer.solution);
  // The multipliers of the equalities are known, so the equalities contribute a constant to the
  // gradient.
  Qp qp = problem.hard;
  qp.f() += problem.E.transpose() * answer.equality;
  const Eigen::Map<const Eigen::VectorXd> x(answer.solution.x.data(), qp.n());
  const double violation = (problem.E * x - problem.e).lpNorm<Eigen::Infinity>();
  return std::max(violation, KktResidual(qp, answer.solution));
}

}  // namespace predictor::bench
