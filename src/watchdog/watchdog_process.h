// The watchdog as a process of its own beside the run, with a channel of its own to each arm that
// leaves one open.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/shared_run.h"
#include "scenario/machine.h"

namespace predictor {

// The subcommand by which this program becomes it, for WatchdogProcess alone.
inline constexpr const char* kWatchdogSubcommand = "watchdog-process";
int WatchdogMain();

class WatchdogProcess {
 public:
  using Tell = std::function<void(const std::string& text)>;

  // Starts it and waits until it has its channels; if it dies, that is told and it is started
  // again. Throws InputError with what it says, std::runtime_error if there can be no process.
  WatchdogProcess(const Machine& machine, const Scenario& scenario, const Shared<RunBoard>& board,
                  Tell tell);
  ~WatchdogProcess();
  int pid() const;  // 0 while there is none

  // Which arms it can stop, and which stop by themselves alone.
  static std::string Describe(const Machine& machine, const Scenario& scenario);

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
