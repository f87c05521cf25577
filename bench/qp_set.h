// Quadratic programs that the scenarios produce, in both formulations.
#pragma once

#include <string>
#include <vector>

#include "haptics/qp.h"
#include "recording.h"

namespace predictor::bench {

// One problem: as rendering poses it, and as the paper does, with the relative pose as equality
// E x = e of six rows instead of a heavily weighed term of the objective.
struct Problem {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
  Qp weighed{1, 0};
  Qp hard{1, 0};
  Rows E;
  Vector6 e;
  double gap =
      0;  // between the recorded command and the solution of this problem [rad/s]; -1 unknown
};

struct ProblemSet {
  std::string name;
  std::vector<Problem> problems;
};

// Every `stride`-th tick of a recording.
ProblemSet FromRecording(const Recording& recording, const std::string& name, int stride);

// Postures drawn at random between, at and up to 0.05 rad beyond the joint limits, every third with
// one arm stretched nearly straight, and a target up to 5 cm, 0.2 rad away. The same ones each
// time.
ProblemSet AtTheLimits(const Recording& recording, int count);

}  // namespace predictor::bench
