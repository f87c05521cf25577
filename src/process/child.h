// Implements what a process alongside the run does itself: it reads its input, gives up rights, and
// ends.
#pragma once

#include <functional>
#include <string>

#include "process/control_channel.h"
#include "process/sandbox.h"

namespace predictor {

// Such a process must end by itself. Such a process then ends by itself.
inline constexpr const char* kOutlivesTheRun = "outlives_the_run";

// Runs a process alongside the run from start to end. The function limits the process's resources,
// reads the first line from the run, and calls `serve`. Exceptions thrown by `serve` are reported
// to the run. Returns an exit code. `name` has at most 15 characters, and `ps` shows it.
int ChildMain(const char* name, const std::function<void(const Json& start)>& serve);

// Call this function before any data from elsewhere are read. Enters the first stage of the sandbox
// (process/sandbox.h). GiveUpRights continues with the second stage and reports the protections
// that this system lacks.
void Prepare(const Preparation& may);

// Gives up the rights of root, continues as the user `nobody`, and forbids writing files. The
// process ends when the run ends, unless kOutlivesTheRun is set. Throws std::runtime_error if the
// rights cannot be given up. A process that cannot enter the sandbox uses this function instead of
// GiveUpRights.
void GiveUpRoot(const Json& start);

// Call this function when everything has been read and the port is open. After this call, the
// process cannot open files, start processes, make connections, or affect other processes. If the
// user was root, the process continues as the user `nobody`. The process ends when the run ends,
// unless kOutlivesTheRun is set. Restrictions that this system does not support are reported to the
// run. `who` is "The viewer", for example. Throws std::runtime_error if root's rights cannot be
// given up.
void GiveUpRights(const Json& start, const std::string& who);

}  // namespace predictor
