// A sandbox that a process enters voluntarily: the kernel then refuses many actions, whichever user
// runs the process.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

// Sanitizers need additional memory, processes and files. In builds with sanitizers, no process
// enters the sandbox.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

// Actions that a process may still perform while it prepares to serve.
struct Preparation {
  std::vector<std::filesystem::path> read;   // files, and folders with everything below them
  std::vector<std::filesystem::path> write;  // likewise: may be read, written, created and removed
  bool listen = false;                       // open TCP ports
  bool give_up_more = false;                 // change its user, and enter the second stage
};

// The two functions below restrict this process permanently and do not need root. Both functions
// return a description of the protections that this system lacks, or "" if it lacks none. Each of
// these functions uses Landlock and a list of allowed system calls (seccomp). A call that is not on
// the list fails with EPERM and does not end the process. If a C library uses a different call for
// the same purpose, the user then sees an error message. If the process were killed instead, it
// would only restart and be killed again. A call that belongs to another processor architecture
// ends the process. Both functions refuse to execute programs, to create processes and threads, to
// open connections, to send signals to other processes, to trace, to share memory, and to change
// file attributes.
//
// Enters the first stage, before any foreign data is read. Paths that do not exist are ignored.
std::string EnterPreparation(const Preparation& may);
// After the second stage, the process can still read from, write to and accept from the files and
// sockets that are open. No file or port can be opened, and no file can be looked up.
std::string EnterSandbox();

}  // namespace predictor
