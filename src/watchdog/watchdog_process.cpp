#include "watchdog/watchdog_process.h"

#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/real_time.h"
#include "devices/stop_channel.h"
#include "process/attached_run.h"
#include "process/child.h"
#include "watchdog/watchdog.h"

namespace predictor::watchdog {
namespace {

std::uint64_t Now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

void Say(const std::string& text) { SendLine(kControlDescriptor, {{"say", text}}, false); }

// The watchdog must run even if the control loop no longer yields its core. It must also not wait
// until its memory is paged in.
void AskForRealTime() {
  constexpr int kPriority = 85;
  rlimit allowed{};
  getrlimit(RLIMIT_RTPRIO, &allowed);
  sched_param priority{};
  for (const int wanted :
       {kPriority, static_cast<int>(std::min<rlim_t>(allowed.rlim_cur, kPriority))}) {
    priority.sched_priority = wanted;
    if (wanted < kLoopPriority || sched_setscheduler(0, SCHED_FIFO, &priority) != 0) continue;
    if (wanted < kPriority)
      Say("The watchdog only has priority " + std::to_string(wanted) +
          ", so a control loop that blocks its core could delay it. Allow priority " +
          std::to_string(kPriority) + " with `ulimit -r 85`.");
    break;
  }
  if (sched_getscheduler(0) != SCHED_FIFO)
    Say("The watchdog has no real-time priority, so any other program could delay it. Allow "
        "real-time priorities with `ulimit -r 85` or CAP_SYS_NICE.");
  if (mlockall(MCL_CURRENT) != 0)
    Say(std::string("The watchdog's memory cannot be locked (") + std::strerror(errno) +
        "), so it may be late when memory is short. Allow locked memory with `ulimit -l "
        "unlimited`.");
}

// Returns false if the run's process has ended, which closes the pipe. This process sends only one
// line, at the start.
bool WaitAMillisecond() {
  pollfd run{kControlDescriptor, POLLIN, 0};
  return poll(&run, 1, 1) == 0 || (run.revents & (POLLHUP | POLLERR | POLLIN)) == 0;
}

// The watchdog's channels to the arms, and the messages about these channels.
class Channels {
 public:
  // `again` states whether the watchdog has watched the arms before. At first, an arm without a
  // channel is an error (throws DeviceError). Later, the watchdog still watches the other arms.
  Channels(const Json& hosts, bool again, Network* network) {
    for (const Json& host : hosts) {
      channels_.push_back({host, nullptr});
      try {
        channels_.back().stop = OpenStopChannel({ArmMake::kUr, host}, network);
      } catch (const DeviceError& error) {
        if (!again) throw;
        Say(std::string("The watchdog: ") + error.what());
      }
    }
  }

  void Tend() {
    for (Channel& channel : channels_) {
      if (!channel.stop) continue;
      const StopChannel::Link link = channel.stop->Tend();
      if (link == channel.link) continue;
      if (link == StopChannel::Link::kTalks)
        Say("The watchdog receives data from " + channel.host + " again.");
      else if (link == StopChannel::Link::kSilent)
        Say("The watchdog receives no data from " + channel.host +
            " (port 30001). If the control loop hangs now, the watchdog may not be able to stop "
            "that arm. Check its network.");
      else
        Say("The watchdog has lost its channel to " + channel.host +
            " (port 30001). Until the channel is restored, only that arm's own time-out stops it.");
      channel.link = link;
      if (link == StopChannel::Link::kLost) channel.stop.reset();
    }
  }

  void Stop() {
    for (const Channel& channel : channels_)
      if (!channel.stop || !channel.stop->Stop())
        Say("The watchdog could not reach " + channel.host + ".");
  }

  bool AnyLost() const { return std::ranges::any_of(channels_, &Channels::IsLost); }
  bool AllLost() const { return std::ranges::all_of(channels_, &Channels::IsLost); }

 private:
  struct Channel {
    std::string host;
    std::unique_ptr<StopChannel> stop;  // null: lost
    StopChannel::Link link = StopChannel::Link::kTalks;
  };
  static bool IsLost(const Channel& channel) { return !channel.stop; }

  std::vector<Channel> channels_;
};

// Returns whether this process must restart to open a new channel. A restart is necessary because
// the process has given up the right to connect. The process does not restart as long as another
// arm has a channel and may move. The process also waits before a restart, so that it does not
// retry continuously if the connection is refused.
bool MustStartAgain(const Channels& channels, RunState state, std::uint64_t age) {
  constexpr std::uint64_t kPause = 2'000'000'000;  // [ns]
  return channels.AnyLost() && (channels.AllLost() || !MayMove(state)) && age > kPause;
}

// Follows the ticks of the run, and the state in the latest tick.
class Ticks {
 public:
  explicit Ticks(const RunBoard& board) : records_(board.records) {}
  void Look() {
    count_ = records_.written();
    if (count_ > 0 && records_.Get(count_ - 1, &record_)) state_ = record_.state;
  }
  std::uint64_t count() const { return count_; }
  RunState state() const { return state_; }

 private:
  const RecordRing& records_;
  std::uint64_t count_ = 0;
  TickRecord record_;
  RunState state_ = RunState::kInit;
};

void Watch(const RunBoard& board, std::atomic<std::uint32_t>* beats, Channels* channels) {
  Watchdog watchdog;
  Ticks ticks(board);
  const std::uint64_t born = Now();
  while (WaitAMillisecond()) {
    beats->fetch_add(1, std::memory_order_release);
    ticks.Look();
    const std::uint64_t now = Now();
    if (watchdog.Look(ticks.count(), ticks.state(), now)) {
      channels->Stop();
      Say("The control loop hung, and the watchdog stopped the arms.");
    }
    channels->Tend();
    if (MustStartAgain(*channels, ticks.state(), now - born))
      throw std::runtime_error("The watchdog restarts to open a new channel.");
  }
  ticks.Look();
  if (MayMove(ticks.state())) channels->Stop();  // the program died or ended in motion
}

void Serve(const Json& start) {
  const Shared<RunBoard> board(kBoardDescriptor, false);
  Shared<WatchdogMailbox> mailbox(kMailboxDescriptor, true);
  const std::unique_ptr<Network> network = SocketNetwork();
  Channels channels(start["hosts"], start.contains("again"), network.get());
  AskForRealTime();
  GiveUpRights(start, "The watchdog");
  SendLine(kControlDescriptor, {{"ready", "watches"}}, false);
  Watch(*board, &mailbox->beats, &channels);
}

using Hands = std::array<bool, kHands>;

// Addresses of the arms that accept a second channel.
std::vector<std::string> Hosts(const Machine& machine, const Hands& hands) {
  std::vector<std::string> hosts;
  for (int hand = 0; hand < kHands; ++hand)
    if (hands[static_cast<std::size_t>(hand)] && machine.arm(hand)->connection.make == ArmMake::kUr)
      hosts.push_back(machine.arm(hand)->connection.host);
  return hosts;
}

std::string DescriptionOf(const Machine& machine, const Hands& hands) {
  std::string text;
  for (int hand = 0; hand < kHands; ++hand) {
    const auto i = static_cast<std::size_t>(hand);
    if (!hands[i]) continue;
    const bool ur = machine.arm(hand)->connection.make == ArmMake::kUr;
    text += (text.empty() ? "" : "; ") + std::string(kHandNames[i]) +
            (ur ? " arm: separate stop channel"
                : " arm: none (the robot stops by itself when commands stop arriving)");
  }
  return text;
}

}  // namespace

WatchdogProcess::WatchdogProcess(const Machine& machine, const Hands& hands,
                                 const Shared<RunBoard>& board, const Notify& notify)
    : description_(DescriptionOf(machine, hands)),
      process_({"The watchdog",
                kWatchdogSubcommand,
                {{"hosts", Hosts(machine, hands)}, {kOutlivesTheRun, true}},
                board.descriptor(),
                mailbox_.descriptor(),
                notify,
                [notify, first = true](const Json& line) mutable {
                  if (line.contains("ready") && !std::exchange(first, false))
                    notify("The watchdog is running again.");
                },
                std::chrono::milliseconds(250),
                &mailbox_->beats,
                "without it, motion stops after 1 s"}) {
  process_.Remember("again", true);
}

int WatchdogMain() { return ChildMain("watchdog", Serve); }

}  // namespace predictor::watchdog
