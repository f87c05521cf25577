// Reads a file of unknown origin in a child process that has almost no other access to the system.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "process/sandbox.h"

namespace predictor {

// The reason why a sandboxed call returned nothing, as a clause without a full stop: "its reader
// crashed (signal 11)".
struct SandboxedFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SandboxedLimits {
  std::size_t max_bytes;  // maximum size of the result
  double max_time;        // [s]
};

// Runs `produce` in a forked child and returns its bytes. The child enters the first stage of the
// sandbox (process/sandbox.h), may read only `readable`, and inherits no descriptors. The child is
// killed when it exceeds a limit, so the caller waits at most `max_time`. Throws SandboxedFailure
// if the child crashes or exceeds a limit, or with the message of an exception that `produce`
// threw. The caller must check the bytes, because the file's author may control the child. It must
// not be called in a tick.
std::vector<std::byte> CallSandboxed(const std::vector<std::filesystem::path>& readable,
                                     const SandboxedLimits& limits,
                                     const std::function<std::vector<std::byte>()>& produce);

}  // namespace predictor
