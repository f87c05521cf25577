// Runs a controller as a separate process that answers through shared memory.
#pragma once

#include <predictor/controller.h>

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/shared_process.h"

namespace predictor {

class ControllerProcess {
 public:
  // Starts the program in `folder`, with the shared memory as descriptor 3. Throws InputError.
  ControllerProcess(const std::vector<std::string>& command, const std::filesystem::path& folder);
  // Asks the program to end, and ends it by force if it keeps running.
  ~ControllerProcess();
  ControllerProcess(const ControllerProcess&) = delete;
  ControllerProcess& operator=(const ControllerProcess&) = delete;

  // Returns the contents of the next request, and of the last answer.
  PredictorControllerMemory& shared() noexcept { return *shared_; }

  // Sends a request of this kind and always waits for the answer. Returns false if the program
  // ends, or does not answer within `limit` [s].
  bool AskAndWait(int kind, double limit) noexcept;

  // This function may be called in a tick in real time, because it uses no system calls and no
  // locks. Sends a request unless the last one is still unanswered, and waits for the answer until
  // `deadline` [s] has passed.
  bool AskAndWatch(int kind, double deadline) noexcept;

  // Returns true while an answer to an earlier request may still arrive. While this is possible,
  // the emulator must not write to the memory `shared`.
  bool IsBusy() const noexcept;
  // As SharedProcess::SetPriority.
  int SetPriority(int priority) noexcept { return process_.SetPriority(priority); }
  // Returns how the program ended (for example, "exit code 1"), or "" while the program runs.
  std::string HowItEnded() noexcept { return process_.HowItEnded(); }

 private:
  void Send(int kind) noexcept;

  SharedProcess process_;
  PredictorControllerMemory* shared_;
  std::uint32_t request_ = 0;  // number of the last request: the program can write the shared one
};

}  // namespace predictor
