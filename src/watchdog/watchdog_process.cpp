#include "watchdog/watchdog_process.h"

#include <poll.h>
#include <sched.h>
#include <time.h>

#include <utility>
#include <vector>

#include "devices/stop_channel.h"
#include "process/attached_run.h"
#include "process/child.h"
#include "process/supervised_process.h"
#include "watchdog/watchdog.h"

namespace predictor {
namespace {

std::uint64_t Now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

// It must run when the loop, at 80, does not give way any more.
void AskForRealTime() {
  sched_param priority{};
  priority.sched_priority = 85;
  sched_setscheduler(0, SCHED_FIFO, &priority);
}

// False when the run is gone.
bool WaitAMillisecond() {
  pollfd run{kControlDescriptor, POLLIN, 0};
  return poll(&run, 1, 1) == 0 || (run.revents & (POLLHUP | POLLERR | POLLIN)) == 0;
}

void Watch(const RunBoard& board, const std::vector<std::unique_ptr<StopChannel>>& channels) {
  Watchdog watchdog;
  TickRecord record;
  RunState state = RunState::kInit;
  while (WaitAMillisecond()) {
    const std::uint64_t ticks = board.records.written();
    if (ticks > 0 && board.records.Get(ticks - 1, &record)) state = record.state;
    const bool hangs = watchdog.Look(ticks, state, Now());
    for (const auto& channel : channels) {
      channel->Tend();
      if (hangs && !channel->Stop())
        SendLine(kControlDescriptor, {{"say", "The watchdog could not reach an arm."}}, false);
    }
    if (hangs)
      SendLine(kControlDescriptor, {{"say", "The loop hung: the watchdog stopped the arms."}},
               false);
  }
}

void Serve(const Json& start) {
  const Shared<RunBoard> board(kBoardDescriptor, false);
  const std::unique_ptr<Network> network = SocketNetwork();
  std::vector<std::unique_ptr<StopChannel>> channels;
  for (const Json& host : start["hosts"])
    channels.push_back(OpenStopChannel({ArmMake::kUr, host}, network.get()));
  AskForRealTime();
  GiveUpRights(start, "The watchdog");
  SendLine(kControlDescriptor, {{"ready", "watches"}}, false);
  Watch(*board, channels);
}

// Addresses of the arms that leave a second channel open.
std::vector<std::string> Hosts(const Machine& machine, const Scenario& scenario) {
  std::vector<std::string> hosts;
  for (int hand = 0; hand < kHands; ++hand)
    if (scenario.Has(hand) && machine.arm(hand)->connection.make == ArmMake::kUr)
      hosts.push_back(machine.arm(hand)->connection.host);
  return hosts;
}

}  // namespace

struct WatchdogProcess::Impl {
  SupervisedProcess process;
};

WatchdogProcess::WatchdogProcess(const Machine& machine, const Scenario& scenario,
                                 const Shared<RunBoard>& board, Tell tell) {
  ChildSetup setup{"The watchdog",
                   kWatchdogSubcommand,
                   {{"hosts", Hosts(machine, scenario)}},
                   board.descriptor(),
                   -1,
                   std::move(tell),
                   [](const Json&) {}};
  impl_ = std::unique_ptr<Impl>(new Impl{SupervisedProcess(std::move(setup))});
}

WatchdogProcess::~WatchdogProcess() = default;
int WatchdogProcess::pid() const { return impl_->process.pid(); }

std::string WatchdogProcess::Describe(const Machine& machine, const Scenario& scenario) {
  std::string text;
  for (int hand = 0; hand < kHands; ++hand) {
    if (!scenario.Has(hand)) continue;
    const bool ur = machine.arm(hand)->connection.make == ArmMake::kUr;
    text +=
        (text.empty() ? "" : "; ") + std::string(kHandNames[static_cast<std::size_t>(hand)]) +
        (ur ? ": by a channel of its own" : ": none, the robot stops by itself when we are silent");
  }
  return text;
}

int WatchdogMain() { return ChildMain("watchdog", Serve); }

}  // namespace predictor
