// The solvers that were compared, behind one interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "qp_set.h"

namespace predictor::bench {

struct Answer {
  QpSolution solution;                 // multipliers in Qp's order and sign
  Vector6 equality = Vector6::Zero();  // multipliers of E x = e
};

class Candidate {
 public:
  virtual ~Candidate() = default;
  virtual std::string name() const = 0;
  virtual bool hard() const = 0;  // solves Problem::hard with E x = e, else Problem::weighed
  // From the matrices of the problem to its solution, with all that the solver needs in between.
  virtual void Solve(const Problem& problem, Answer* answer) = 0;
};

// For problems of the size of `example`.
std::vector<std::unique_ptr<Candidate>> MakeCandidates(const Problem& example);
std::unique_ptr<Candidate> MakeDaqp(const Problem& example, bool hard);
std::unique_ptr<Candidate> MakeEiquadprogFast(const Problem& example, bool hard);
std::unique_ptr<Candidate> MakeEiquadprogRt(
    const Problem& example);  // null but for two arms of 7 joints
std::unique_ptr<Candidate> MakeProxQp(const Problem& example, bool hard, bool warm);

// KktResidual of the formulation that the candidate solved; infinite if it gave up.
double Residual(const Problem& problem, bool hard, const Answer& answer);

}  // namespace predictor::bench
