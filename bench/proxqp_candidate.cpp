#include <proxsuite/proxqp/dense/dense.hpp>

#include "qp_candidates.h"

namespace predictor::bench {
namespace {

namespace proxqp = proxsuite::proxqp;

class ProxQp final : public Candidate {
 public:
  ProxQp(const Problem& example, bool hard, bool warm)
      : hard_(hard),
        warm_(warm),
        n_(example.weighed.n()),
        m_(example.weighed.m()),
        solver_(n_, hard ? 6 : 0, m_, true),
        open_(Eigen::VectorXd::Constant(m_, 1e20)) {
    solver_.settings.eps_abs = 1e-7;
    solver_.settings.eps_rel = 0;
    solver_.settings.max_iter = 1000;
    solver_.settings.initial_guess =
        warm ? proxqp::InitialGuessStatus::WARM_START_WITH_PREVIOUS_RESULT
             : proxqp::InitialGuessStatus::EQUALITY_CONSTRAINED_INITIAL_GUESS;
    Load(example);
    solver_.init(H_, f_, E_, e_, A_, b_, open_, lower_, upper_);
  }
  std::string name() const override { return warm_ ? "ProxQP, warm" : "ProxQP"; }
  bool hard() const override { return hard_; }

  void Solve(const Problem& problem, Answer* answer) override {
    Load(problem);
    solver_.update(H_, f_, E_, e_, A_, b_, open_, lower_, upper_, true);
    solver_.solve();
    const auto& r = solver_.results;
    answer->solution.solved = r.info.status == proxqp::QPSolverOutput::PROXQP_SOLVED;
    answer->solution.iterations = static_cast<int>(r.info.iter);
    std::copy_n(r.x.data(), n_, answer->solution.x.begin());
    std::copy_n(r.z.data() + m_, n_, answer->solution.multiplier.begin());
    std::copy_n(r.z.data(), m_, answer->solution.multiplier.begin() + n_);
    if (hard_) answer->equality = r.y;
    // After a failure, the solver's state is not a valid start for the next problem.
    if (!answer->solution.solved) solver_.cleanup();
    if (!answer->solution.solved) solver_.init(H_, f_, E_, e_, A_, b_, open_, lower_, upper_);
  }

 private:
  void Load(const Problem& problem) {
    const Qp& qp = hard_ ? problem.hard : problem.weighed;
    H_ = qp.H();
    f_ = qp.f();
    A_ = qp.A();
    b_ = qp.b();
    lower_ = qp.lower().cwiseMax(-1e20);
    upper_ = qp.upper().cwiseMin(1e20);
    E_ = hard_ ? Eigen::MatrixXd(problem.E) : Eigen::MatrixXd(0, n_);
    e_ = hard_ ? Eigen::VectorXd(problem.e) : Eigen::VectorXd(0);
  }

  bool hard_, warm_;
  int n_, m_;
  proxqp::dense::QP<double> solver_;
  Eigen::MatrixXd H_, E_, A_;
  Eigen::VectorXd f_, e_, b_, open_, lower_, upper_;
};

}  // namespace

std::unique_ptr<Candidate> MakeProxQp(const Problem& example, bool hard, bool warm) {
  return std::make_unique<ProxQp>(example, hard, warm);
}

}  // namespace predictor::bench
