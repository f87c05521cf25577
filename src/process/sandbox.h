// What the kernel refuses a process that asked for it, whoever it is run by.
#pragma once

#include <string>

namespace predictor {

// For this process, for good: Landlock with an empty set of rules (no file may be opened, no TCP
// port bound or connected to, as far as the kernel knows of these) and a filter of system calls (no
// opening, executing, forking, new sockets, tracing, signals to others). Needs no root, but
// PR_SET_NO_NEW_PRIVS. Returns what was not to be had, in words; empty if nothing.
std::string EnterSandbox();

}  // namespace predictor
