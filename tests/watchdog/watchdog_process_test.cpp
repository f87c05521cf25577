// Tests the watchdog's process: its reaction to the end of the run, and to its own faults.
#include "watchdog/watchdog_process.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <mutex>
#include <thread>
#include <tuple>
#include <vector>

#include "support/process.h"

namespace predictor::watchdog {
namespace {

using test::Becomes;

// A UR's port for programs. The port sends data ten times a second, as controllers do, and stores
// the data that it receives.
class ProgramPort {
 public:
  // The port has an address that no other test uses.
  ProgramPort()
      : host_("127.77." + std::to_string(getpid() / 250 % 250) + "." +
              std::to_string(1 + getpid() % 250)) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(30001);
    EXPECT_EQ(inet_pton(AF_INET, host_.c_str(), &address.sin_addr), 1);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listener_, 4), 0);
    thread_ = std::thread([this] { Serve(); });
  }
  ~ProgramPort() {
    done_ = true;
    thread_.join();
    for (const int client : clients_) close(client);
    close(listener_);
  }
  const std::string& host() const { return host_; }
  std::string heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  void Serve() {
    for (int k = 0; !done_; ++k) {
      pollfd ready{listener_, POLLIN, 0};
      if (poll(&ready, 1, 10) > 0) clients_.push_back(accept(listener_, nullptr, nullptr));
      for (const int client : clients_) {
        if (k % 10 == 0) std::ignore = send(client, "state", 5, MSG_NOSIGNAL | MSG_DONTWAIT);
        char text[4096];
        const ssize_t n = recv(client, text, sizeof text, MSG_DONTWAIT);
        const std::lock_guard lock(mutex_);
        if (n > 0) heard_.append(text, static_cast<std::size_t>(n));
      }
    }
  }

  std::string host_;
  int listener_ = -1;
  std::vector<int> clients_;
  std::mutex mutex_;
  std::string heard_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

class WatchdogProcessTest : public testing::Test {
 protected:
  WatchdogProcessTest() {
    machine_.left.emplace();
    machine_.left->connection.make = ArmMake::kUr;
    machine_.left->connection.host = port_.host();
    loop_ = std::thread([this] {
      TickRecord record{};
      while (!done_) {
        ++record.tick;
        record.state = state_;
        board_->records.Publish(record);
        ++ticks_;
        std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
    });
    watchdog_ = std::make_unique<WatchdogProcess>(machine_, std::array{true, false}, board_,
                                                  [this](const std::string& text) {
                                                    const std::lock_guard lock(mutex_);
                                                    reported_ += text + "\n";
                                                  });
  }
  ~WatchdogProcessTest() override {
    watchdog_.reset();
    done_ = true;
    loop_.join();
  }
  bool Reports(const std::string& text) {
    return Becomes([&] {
      const std::lock_guard lock(mutex_);
      return reported_.find(text) != std::string::npos;
    });
  }
  // Waits until the loop has published the state.
  void Enter(RunState state) {
    state_ = state;
    const std::uint64_t ticks = ticks_;
    EXPECT_TRUE(Becomes([&] { return ticks_ > ticks + 1; }));
  }
  bool Beats() {
    const std::uint32_t beats = watchdog_->beats();
    return Becomes([&] { return watchdog_->beats() - beats > 5; });
  }

  ProgramPort port_;
  Machine machine_;
  Shared<RunBoard> board_;
  std::atomic<RunState> state_{RunState::kIdle};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<bool> done_{false};
  std::thread loop_;
  std::mutex mutex_;
  std::string reported_;
  std::unique_ptr<WatchdogProcess> watchdog_;
};

TEST_F(WatchdogProcessTest, BeatsAndStopsNothingWhereTheRunEndsAtRest) {
  EXPECT_TRUE(Beats());
  const int pid = watchdog_->pid();
  watchdog_.reset();
  EXPECT_NE(kill(pid, 0), 0);
  EXPECT_EQ(port_.heard(), "");
}

// The loop continues to tick, so the watchdog must not detect a hang.
TEST_F(WatchdogProcessTest, StopsTheArmsWhereTheRunEndsInMotion) {
  EXPECT_TRUE(Beats());
  Enter(RunState::kRun);
  watchdog_.reset();
  EXPECT_TRUE(Becomes([&] { return port_.heard().find("stopj") != std::string::npos; }));
}

// The program is killed during a motion. The program's end of the channel closes. The program's
// watchdog continues to run and must stop the arms.
TEST(WatchdogOfAKilledProgram, StopsTheArms) {
  ProgramPort port;
  const pid_t program = fork();
  if (program == 0) {
    Machine machine;
    machine.left.emplace();
    machine.left->connection.make = ArmMake::kUr;
    machine.left->connection.host = port.host();
    Shared<RunBoard> board;
    TickRecord record{};
    record.state = RunState::kRun;
    const WatchdogProcess watchdog(machine, {true, false}, board, [](const std::string&) {});
    board->records.Publish(record);
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(program, &status, 0), program);
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
  EXPECT_TRUE(Becomes([&] { return port.heard().find("stopj") != std::string::npos; }));
}

TEST_F(WatchdogProcessTest, IsStartedAgainWhereItIsStopped) {
  EXPECT_TRUE(Beats());
  const int pid = watchdog_->pid();
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  EXPECT_TRUE(Reports("The watchdog does not respond: without it, motion stops after 1 s."));
  const std::uint32_t beats = watchdog_->beats();
  EXPECT_TRUE(Reports("The watchdog did not respond and was ended"));
  EXPECT_TRUE(Reports("The watchdog is running again."));
  EXPECT_NE(watchdog_->pid(), pid);
  EXPECT_TRUE(Becomes([&] { return watchdog_->beats() != beats; }));
}

}  // namespace
}  // namespace predictor::watchdog
