// The watchdog as a process of its own beside the run, with a channel of its own to each arm that
// leaves one open.
#pragma once

#include <array>
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
  // again. hands: whose arms move. It goes by the ticks that are published on the board, and the
  // state that they tell. Throws InputError with what it says, std::runtime_error if there can be
  // no process.
  WatchdogProcess(const Machine& machine, const std::array<bool, kHands>& hands,
                  const Shared<RunBoard>& board, Tell tell);
  ~WatchdogProcess();
  int pid() const;  // 0 while there is none

  // Which arms it can stop, and which stop by themselves alone.
  const std::string& Describe() const { return description_; }

  struct Impl;

 private:
  std::string description_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
