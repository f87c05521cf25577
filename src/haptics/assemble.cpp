#include "haptics/assemble.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "core/error.h"
#include "haptics/registry.h"

namespace predictor {
namespace {

static_assert(kMaxArmJoints <= 16 && kMaxLimitRows <= 16, "bits of RenderResult");

template <class Made>
std::vector<const char*> NamesOf(std::span<const RenderingKind<Made>* const> all) {
  std::vector<const char*> names;
  for (const RenderingKind<Made>* kind : all) names.push_back(kind->name);
  return names;
}

// Makes the entries with these names, in the registry's order.
template <class Made>
std::vector<std::unique_ptr<Made>> MakeNamed(std::span<const RenderingKind<Made>* const> all,
                                             std::span<const char* const> names,
                                             const RenderSetup& setup) {
  std::vector<std::unique_ptr<Made>> made;
  Problems problems;
  for (const RenderingKind<Made>* kind : all) {
    if (std::find(names.begin(), names.end(), std::string_view(kind->name)) == names.end())
      continue;
    const auto own =
        ParametersOfPart(*kind, setup.scenario.rendering.parts, "rendering", &problems);
    problems.ThrowIfAny();
    made.push_back(kind->make(setup, *own));
  }
  return made;
}

}  // namespace

Assembler::Assembler(const RenderSetup& setup)
    : Assembler(setup, NamesOf(RegisteredTasks()), NamesOf(RegisteredLimits())) {}

Assembler::Assembler(const RenderSetup& setup, std::span<const char* const> tasks,
                     std::span<const char* const> limits)
    : soft_(setup.repairs.Has(Repair::kSoftRows)),
      joints_(setup.joints),
      tasks_(MakeNamed<Task>(RegisteredTasks(), tasks, setup)),
      limits_(MakeNamed<Limit>(RegisteredLimits(), limits, setup)) {
  for (const auto& limit : limits_) limit_rows_ += limit->rows();
  for (const auto& task : tasks_)
    if (task->has_precedence()) precedence_rows_ += 6 * static_cast<int>(task->terms().size());
  const auto check = [](const std::string& what, int rows, int most, const char* remedy) {
    if (rows > most)
      throw InputError("The " + what + " need " + std::to_string(rows) + " rows, but at most " +
                       std::to_string(most) + " are possible. " + remedy);
  };
  check("limits", limit_rows_, kMaxLimitRows, "Remove some of rendering.link_pairs.");
  check("tasks with precedence", precedence_rows_, kMaxPrecedenceRows,
        "Register fewer tasks or limits (src/haptics/registry.h).");
}

Qp Assembler::MakeQp(Precedence form) const {
  const int rows = limit_rows_ + (form == Precedence::kWeights ? 0 : precedence_rows_);
  return {joints_ + (form == Precedence::kHard ? 0 : rows), rows};
}

void Assembler::Update(const RenderContext& context) noexcept {
  objective_.gradient.setZero(joints_);
  objective_.damping.setZero(joints_);
  for (const auto& task : tasks_) task->Update(context, &objective_);
}

void Assembler::Assemble(const RenderContext& context, Precedence form, Qp* qp) noexcept {
  qp->Clear();
  for (const auto& task : tasks_)
    if (!task->has_precedence())
      for (const TaskTerm& term : task->terms()) AddByWeight(term, qp);
  qp->f().head(joints_) -= objective_.gradient;
  qp->H().diagonal().head(joints_) += objective_.damping;

  AddLimits(context, form, qp);
  int row = limit_rows_;
  for (const auto& task : tasks_) {
    if (!task->has_precedence()) continue;
    for (const TaskTerm& term : task->terms()) {
      if (form == Precedence::kWeights) {
        AddByWeight(term, qp);
      } else {
        AddRows(term, row, form, qp);
        row += 6;
      }
    }
  }
}

void Assembler::AddLimits(const RenderContext& context, Precedence form, Qp* qp) noexcept {
  int row = 0;
  for (const auto& limit : limits_) {
    LimitRows rows(qp, joints_, row, limit->rows());
    limit->AddTo(context, &rows);
    row += limit->rows();
  }
  if (form == Precedence::kHard) return;
  // Each row has a slack variable. The slack variable is scaled so that its weight in H is 1.
  for (int r = 0; r < row; ++r) {
    qp->H()(joints_ + r, joints_ + r) = 1;
    qp->A()(r, joints_ + r) = 1 / std::sqrt(kLimitSlackWeight);
  }
}

void AddByWeight(const TaskTerm& term, Qp* qp) noexcept {
  auto H = qp->H();
  auto f = qp->f();
  const int o = term.first;
  for (int c = 0; c < term.J.cols(); ++c) {
    const Vector6 weighted = term.weight.cwiseProduct(term.J.col(c));
    f[o + c] -= weighted.dot(term.rate);
    for (int r = 0; r <= c; ++r) {
      const double h = weighted.dot(term.J.col(r));
      H(o + r, o + c) += h;
      if (r != c) H(o + c, o + r) += h;
    }
  }
}

// Adds six rows J x + s/√w = rate, starting at `row`. Each of these rows has a slack variable s.
// For an inactive term, s is 0. The hard form has neither slack nor rows for inactive terms.
void Assembler::AddRows(const TaskTerm& term, int row, Precedence form, Qp* qp) const noexcept {
  const bool in_force = term.J.cols() > 0;
  const bool hard = form == Precedence::kHard;
  if (hard && !in_force) return;
  for (int k = 0; k < 6; ++k) {
    const int r = row + k, slack = joints_ + r;
    if (in_force) qp->A().row(r).segment(term.first, term.J.cols()) = term.J.row(k);
    if (!hard) {
      qp->A()(r, slack) = in_force ? 1 / std::sqrt(term.weight[k]) : 1;
      qp->H()(slack, slack) = 1;
    }
    qp->b()[r] = qp->b_upper()[r] = in_force ? term.rate[k] : 0;
  }
}

void Assembler::Publish(const double* x, RenderResult* result) const noexcept {
  for (const auto& task : tasks_) task->Publish(x, result);
  for (const auto& limit : limits_) limit->Publish(result);
  if (!x) return;
  result->slack_by_limit = {};
  result->limit_slack = 0;
  if (!soft_) return;
  int row = joints_;
  for (std::size_t l = 0; l < limits_.size(); ++l) {
    double& slack = result->slack_by_limit[l];
    for (int r = 0; r < limits_[l]->rows(); ++r, ++row)
      slack = std::max(slack, std::abs(x[row]) / std::sqrt(kLimitSlackWeight));
    result->limit_slack = std::max(result->limit_slack, slack);
  }
}

void Assembler::Reset() noexcept {
  for (const auto& task : tasks_) task->Reset();
}

void Assembler::Archive(StateArchive& a) noexcept {
  for (const auto& task : tasks_) task->Archive(a);
}

std::vector<TaskTerm> Assembler::PrecedenceTerms() const {
  std::vector<TaskTerm> terms;
  for (const auto& task : tasks_)
    if (task->has_precedence())
      terms.insert(terms.end(), task->terms().begin(), task->terms().end());
  return terms;
}

}  // namespace predictor
