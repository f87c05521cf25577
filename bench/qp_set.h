// The quadratic programs that the scenarios produce, in both formulations.
#pragma once

#include <string>
#include <vector>

#include "qp/qp.h"
#include "recording.h"

namespace predictor::bench {

// One problem in two formulations: the formulation that rendering uses, and the paper's
// formulation. In the paper's formulation, the relative pose is an equality E x = e of six rows. In
// our formulation, the relative pose is a heavily weighted term of the objective.
struct Problem {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
  Qp weighed{1, 0};
  Qp hard{1, 0};
  Rows E;
  Vector6 e;
  double gap =
      // Difference between the recorded command and the solution of this problem [rad/s]; -1:
      // unknown.
      0;
};

struct ProblemSet {
  std::string name;
  std::vector<Problem> problems;
};

// Uses every `stride`-th tick of a recording.
ProblemSet FromRecording(const Recording& recording, const std::string& name, int stride);

// Returns problems in random postures between the joint limits, at the joint limits, and up to 0.05
// rad beyond the joint limits. In every third posture, one arm is nearly straight. The target is up
// to 5 cm and 0.2 rad away from the current pose. The postures are the same in each call.
ProblemSet AtTheLimits(const Recording& recording, int count);

}  // namespace predictor::bench
