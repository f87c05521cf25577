// The watchdog as a separate process alongside the run, with its own channel to each arm that
// accepts one.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "core/shared_run.h"
#include "process/supervised_process.h"
#include "scenario/machine.h"

namespace predictor::watchdog {

// The internal subcommand that turns this program into the watchdog. Only WatchdogProcess uses it.
inline constexpr const char* kWatchdogSubcommand = "watchdog-process";
int WatchdogMain();

class WatchdogProcess {
 public:
  using Notify = std::function<void(const std::string& text)>;

  // Starts the watchdog and waits until it has its channels. If the watchdog dies, hangs or is
  // stopped, a message reports this. The run's process then tries to restart the watchdog until the
  // restart succeeds. `hands` are the hands whose arms move. The watchdog follows the ticks on the
  // board and the states in them. The watchdog stops the arms if the ticks cease or this process
  // ends in a state in which arms may move. Throws InputError with the watchdog's error message, or
  // std::runtime_error if no process can be started.
  WatchdogProcess(const Machine& machine, const std::array<bool, kHands>& hands,
                  const Shared<RunBoard>& board, const Notify& notify);
  int pid() const { return process_.pid(); }  // 0 while no process is running
  // Returns the heartbeat counter. If the watchdog ends, the motion must end too, because nothing
  // would detect a hanging control loop.
  const std::atomic<std::uint32_t>& beats() const { return (*mailbox_).beats; }

  // Describes which arms the watchdog can stop, and which arms stop only by themselves.
  const std::string& Describe() const { return description_; }

 private:
  std::string description_;
  Shared<WatchdogMailbox> mailbox_;
  SupervisedProcess process_;
};

}  // namespace predictor::watchdog
