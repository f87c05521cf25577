// What a process beside the run has of it.
#pragma once

#include "core/shared_run.h"
#include "process/control_channel.h"
#include "scenario/scenario.h"

namespace predictor {

// Descriptors that such a process is born with; what it may write into is of its own kind.
enum : int { kBoardDescriptor = 3, kMailboxDescriptor = 4, kControlDescriptor = 5 };

// What every such process is told first: what is run, and where its object starts [m in W].
Json RunLine(const Scenario& scenario, const Vector3& object_start);

// The run as a process beside it has it, out of the board and that line.
struct AttachedRun {
  // Throws std::runtime_error if the memory is not that of this version's run.
  explicit AttachedRun(const Json& start);

  const Shared<RunBoard> board;
  Scenario scenario;
  Vector3 object_start;
};

}  // namespace predictor
