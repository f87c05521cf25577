// Assembles the QP of rendering from its tasks and limits.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "haptics/limit.h"
#include "haptics/task.h"
#include "qp/qp.h"

namespace predictor {

// The weight of a limit row's slack. Tracking has weight 1.
inline constexpr double kLimitSlackWeight = 1e9;
inline constexpr double kSingularDamping = 1e-2;  // damping of joints at a singularity

// Form of the problem. The first two forms have the same solution.
enum class Precedence {
  kWeights,  // tasks with precedence get large weights: takes half the time to solve
  kRows,     // tasks with precedence become rows with slack: widely differing weights do not worsen
             // the conditioning
  kHard,     // the paper's (4) and (5): rows without slack, so there may be no solution
};

class Assembler {
 public:
  // Uses all registered tasks and limits. Throws InputError, for example if the limits need too
  // many rows.
  explicit Assembler(const RenderSetup& setup);
  // Uses only the named tasks and limits, for tests and benchmarks.
  Assembler(const RenderSetup& setup, std::span<const char* const> tasks,
            std::span<const char* const> limits);

  // Makes an empty problem of the right size.
  Qp MakeQp(Precedence form) const;
  // Updates the tasks. Call this once per tick.
  void Update(const RenderContext& context) noexcept;
  // Writes the whole problem. Call this after Update, any number of times.
  void Assemble(const RenderContext& context, Precedence form, Qp* qp) noexcept;

  // Writes the values that the tasks and limits publish. `x` is the solution, or null if no
  // solution was found.
  void Publish(const double* x, RenderResult* result) const noexcept;
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // Returns false for the paper's formulation, which must be assembled as kHard.
  bool is_soft() const { return soft_; }
  int joints() const { return joints_; }
  int limit_rows() const { return limit_rows_; }
  // Terms of the tasks that have precedence in this tick.
  std::vector<TaskTerm> PrecedenceTerms() const;

 private:
  void AddLimits(const RenderContext& context, Precedence form, Qp* qp) noexcept;
  void AddRows(const TaskTerm& term, int row, Precedence form, Qp* qp) const noexcept;

  bool soft_;
  int joints_, limit_rows_ = 0, precedence_rows_ = 0;
  std::vector<std::unique_ptr<Task>> tasks_;
  std::vector<std::unique_ptr<Limit>> limits_;
  JointObjective objective_;
};

// Adds a term to the objective.
void AddByWeight(const TaskTerm& term, Qp* qp) noexcept;

}  // namespace predictor
