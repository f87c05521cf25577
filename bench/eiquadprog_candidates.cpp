#include <eiquadprog/eiquadprog-fast.hpp>
#include <eiquadprog/eiquadprog-rt.hpp>

#include "qp_candidates.h"

namespace predictor::bench {
namespace {

constexpr double kOpen = 1e29;  // larger bounds count as infinite

// Writes the bounds and rows of a problem as CI x + ci0 ≥ 0: first the lower and upper bounds of
// the bounded variables, then the rows. The constant part of CI is written once.
template <typename Matrix, typename Vector>
class Inequalities {
 public:
  explicit Inequalities(const Qp& qp) : n_(qp.n()) {
    for (int j = 0; j < n_; ++j) {
      if (qp.upper()[j] < kOpen) bounded_.push_back(j);
    }
    CI.resize(count() + qp.m(), n_);
    ci0.resize(count() + qp.m());
    CI.setZero();
    for (int k = 0; k < count() / 2; ++k) {
      CI(2 * k, bounded_[static_cast<std::size_t>(k)]) = 1;
      CI(2 * k + 1, bounded_[static_cast<std::size_t>(k)]) = -1;
    }
  }
  // Returns the number of bound constraints.
  int count() const { return 2 * static_cast<int>(bounded_.size()); }

  void Load(const Qp& qp) {
    for (int k = 0; k < count() / 2; ++k) {
      const int j = bounded_[static_cast<std::size_t>(k)];
      ci0[2 * k] = -qp.lower()[j];
      ci0[2 * k + 1] = qp.upper()[j];
    }
    CI.bottomRows(qp.m()) = qp.A();
    ci0.tail(qp.m()) = -qp.b();
  }

  // Returns the multipliers from the solver's list of active constraints (equalities: −1 − row).
  template <typename Solver>
  void Unpack(const Solver& solver, Answer* answer) const {
    answer->solution.multiplier.fill(0);
    answer->equality.setZero();
    for (int a = 0; a < static_cast<int>(solver.getActiveSetSize()); ++a) {
      const int c = solver.getActiveSet()[a];
      const double u = solver.getLagrangeMultipliers()[a];
      if (c < 0)
        answer->equality[-1 - c] = -u;
      else if (c < count())
        answer->solution
            .multiplier[static_cast<std::size_t>(bounded_[static_cast<std::size_t>(c / 2)])] +=
            c % 2 == 0 ? -u : u;
      else
        answer->solution.multiplier[static_cast<std::size_t>(n_ + c - count())] = -u;
    }
    answer->solution.iterations = solver.getIteratios();
  }

  Matrix CI;
  Vector ci0;

 private:
  int n_;
  std::vector<int> bounded_;
};

class Fast final : public Candidate {
 public:
  Fast(const Problem& example, bool hard)
      : hard_(hard), inequalities_(hard ? example.hard : example.weighed) {
    const auto n = static_cast<std::size_t>(example.weighed.n());
    solver_.reset(n, hard ? 6 : 0, static_cast<std::size_t>(inequalities_.ci0.size()));
    CE_.resize(hard ? 6 : 0, example.weighed.n());
    ce0_.resize(hard ? 6 : 0);
    x_.resize(example.weighed.n());
  }
  std::string name() const override { return "eiquadprog-fast"; }
  bool hard() const override { return hard_; }
  void Solve(const Problem& problem, Answer* answer) override {
    const Qp& qp = hard_ ? problem.hard : problem.weighed;
    H_ = qp.H();
    f_ = qp.f();
    inequalities_.Load(qp);
    if (hard_) {
      CE_ = problem.E;
      ce0_ = -problem.e;
    }
    answer->solution.solved =
        solver_.solve_quadprog(H_, f_, CE_, ce0_, inequalities_.CI, inequalities_.ci0, x_) ==
        eiquadprog::solvers::EIQUADPROG_FAST_OPTIMAL;
    std::copy_n(x_.data(), qp.n(), answer->solution.x.begin());
    inequalities_.Unpack(solver_, answer);
  }

 private:
  bool hard_;
  Inequalities<Eigen::MatrixXd, Eigen::VectorXd> inequalities_;
  eiquadprog::solvers::EiquadprogFast solver_;
  Eigen::MatrixXd H_, CE_;
  Eigen::VectorXd f_, ce0_, x_;
};

// Uses sizes that are fixed at compile time, for two arms of seven joints and one pair of links.
class Rt final : public Candidate {
 public:
  static constexpr int kVariables = 15;
  static constexpr int kInequalities = 29;
  explicit Rt(const Problem& example) : inequalities_(example.weighed) {}
  static bool Fits(const Problem& example) {
    return example.weighed.n() == kVariables && example.weighed.m() == 1;
  }
  std::string name() const override { return "eiquadprog-rt"; }
  bool hard() const override { return false; }
  void Solve(const Problem& problem, Answer* answer) override {
    H_ = problem.weighed.H();
    f_ = problem.weighed.f();
    inequalities_.Load(problem.weighed);
    answer->solution.solved =
        solver_.solve_quadprog(H_, f_, CE_, ce0_, inequalities_.CI, inequalities_.ci0, x_) ==
        eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL;
    std::copy_n(x_.data(), kVariables, answer->solution.x.begin());
    inequalities_.Unpack(solver_, answer);
  }

 private:
  using Matrix = RtMatrixX<kInequalities, kVariables>::d;
  using Vector = RtVectorX<kInequalities>::d;
  Inequalities<Matrix, Vector> inequalities_;
  eiquadprog::solvers::RtEiquadprog<kVariables, 0, kInequalities> solver_;
  RtMatrixX<kVariables, kVariables>::d H_;
  RtMatrixX<0, kVariables>::d CE_;
  RtVectorX<kVariables>::d f_, x_;
  RtVectorX<0>::d ce0_;
};

}  // namespace

std::unique_ptr<Candidate> MakeEiquadprogFast(const Problem& example, bool hard) {
  return std::make_unique<Fast>(example, hard);
}

std::unique_ptr<Candidate> MakeEiquadprogRt(const Problem& example) {
  if (!Rt::Fits(example)) return nullptr;
  return std::make_unique<Rt>(example);
}

}  // namespace predictor::bench
