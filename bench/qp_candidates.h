// Defines one interface for all compared solvers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "qp_set.h"

namespace predictor::bench {

struct Answer {
  QpSolution solution;                 // multipliers in the order and with the signs of Qp
  Vector6 equality = Vector6::Zero();  // multipliers of E x = e
};

class Candidate {
 public:
  virtual ~Candidate() = default;
  virtual std::string name() const = 0;
  virtual bool hard() const = 0;  // solves Problem::hard with E x = e, otherwise Problem::weighed
  // Solves the problem that the matrices describe. The time includes any conversion that the solver
  // needs.
  virtual void Solve(const Problem& problem, Answer* answer) = 0;
};

// Returns candidates for problems of the same size as `example`.
std::vector<std::unique_ptr<Candidate>> MakeCandidates(const Problem& example);
std::unique_ptr<Candidate> MakeDaqp(const Problem& example, bool hard);
std::unique_ptr<Candidate> MakeEiquadprogFast(const Problem& example, bool hard);
std::unique_ptr<Candidate> MakeEiquadprogRt(
    const Problem& example);  // null unless there are two arms with 7 joints
std::unique_ptr<Candidate> MakeProxQp(const Problem& example, bool hard, bool warm);

// Returns the KktResidual of the formulation that the candidate solved, or infinity if the
// candidate failed.
double Residual(const Problem& problem, bool hard, const Answer& answer);

}  // namespace predictor::bench
