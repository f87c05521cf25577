// The side of a process beside the run: what it is given, what it gives up, how it ends.
#pragma once

#include <functional>
#include <string>

#include "process/control_channel.h"

namespace predictor {

// What such a process does from its birth to its end: bounds its resources, takes the first line
// that the run sends and serves. What `serve` throws is told to the run. Returns an exit code.
// `name`: at most 15 characters, as `ps` shows it.
int ChildMain(const char* name, const std::function<void(const Json& start)>& serve);

// When all is read and the port is open: from here on no file can be opened, no process or
// connection made, no other process touched; the user is nobody if it was root; it ends with the
// run. What this system does not let it give up is told to the run; `who`: "The viewer". Throws
// std::runtime_error if root's rights stay.
void GiveUpRights(const Json& start, const std::string& who);

}  // namespace predictor
