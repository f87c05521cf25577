// Searches for a pose of the virtual world in which fixed arms suit the whole task.
#pragma once

#include "analysis/check/base_search.h"

namespace predictor {

struct ShiftProposal {
  PoseSpec shift;      // X_RW; roll and pitch are 0
  Reach reach;         // with this shift
  double comfort = 0;  // comfort of `reach`
};

// Returns the environment.shift with the greatest comfort over the paths, while the arms keep their
// places. The search starts with the best shift among the current one and a grid. The grid puts the
// bases behind or in front of the handles, and below them. In the grid, either the line between the
// handles is parallel to the line between the bases, or the yaw is the current yaw. If there is
// only one arm, the grid has four yaws, which differ by a quarter turn. The search then moves along
// x, y and z in steps of 0.1, 0.05 and 0.025 m and rotates by 20, 10 and 5°. The result is
// repeatable and rounded to 5 mm and 1°.
ShiftProposal SearchShift(const Scenario& scenario, const TaskPathList& paths,
                          const OnProgress& progress);

}  // namespace predictor
