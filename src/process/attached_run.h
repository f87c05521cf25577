// Gives a process alongside the run access to the run's data.
#pragma once

#include "core/shared_run.h"
#include "process/control_channel.h"
#include "scenario/scenario.h"

namespace predictor {

// The file descriptors that a process alongside the run inherits. Each kind of process may write
// only into its own mailbox. The last two descriptors are for reading the memory of other such
// processes.
enum : int {
  kBoardDescriptor = 3,
  kMailboxDescriptor = 4,
  kControlDescriptor = 5,
  kReadDescriptor = 6,
  kStreamDescriptor = 7
};

// Returns the first line that is sent to every process alongside the run. The line contains the
// scenario and the position of the object at the start [m in W].
Json RunLine(const Scenario& scenario, const Vector3& object_start);

// The run as seen by a process alongside it, constructed from the board and the first line.
struct AttachedRun {
  // Throws std::runtime_error if the memory does not belong to a run of this version.
  explicit AttachedRun(const Json& start);

  const Shared<RunBoard> board;
  Scenario scenario;
  Vector3 object_start;
};

}  // namespace predictor
