// Tests helper processes that end, fall silent or are stopped, and errors in the supervisor itself.
#include "process/supervised_process.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>

#include <csignal>
#include <mutex>
#include <stdexcept>

#include "core/shared_run.h"
#include "process/attached_run.h"
#include "process/child.h"
#include "process/supervised_child.h"
#include "support/process.h"

namespace predictor {
namespace {

using test::Becomes;

// Sends a heartbeat every millisecond and answers each message until the run ends.
void Serve(const Json&) {
  Shared<WatchdogMailbox> mailbox(kMailboxDescriptor, true);
  SendLine(kControlDescriptor, {{"ready", true}}, false);
  pollfd run{kControlDescriptor, POLLIN, 0};
  LineReader lines;
  for (;; ++mailbox->beats) {
    if (poll(&run, 1, 1) == 0) continue;
    if (!lines.Read(kControlDescriptor)) return;
    while (lines.Next()) SendLine(kControlDescriptor, {{"say", "It is there."}}, false);
  }
}

class SupervisedProcessTest : public testing::Test {
 protected:
  void Start(bool beats = true) {
    ChildSetup setup;
    setup.name = "The child";
    setup.subcommand = kTestSubcommand;
    setup.start = Json::object();
    setup.board = board_.descriptor();
    setup.mailbox = mailbox_.descriptor();
    setup.notify = [this](const std::string& text) { Notify(text); };
    setup.hear = [](const Json&) {};
    setup.longest_pause = std::chrono::milliseconds(50);
    if (beats) setup.beats = &mailbox_->beats;
    setup.without = "nothing continues";
    process_ = std::make_unique<SupervisedProcess>(std::move(setup));
  }
  bool Reports(const std::string& text) {
    return Becomes([&] {
      const std::lock_guard lock(mutex_);
      return reported_.find(text) != std::string::npos;
    });
  }
  bool IsThereAgain(int before) {
    return Becomes([&] { return process_->pid() != 0 && process_->pid() != before; });
  }

  // Makes Notify throw once, when it receives a text that contains `text`.
  void ThrowAt(const std::string& text) {
    const std::lock_guard lock(mutex_);
    throws_at_ = text;
  }

 private:
  void Notify(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (!throws_at_.empty() && text.find(throws_at_) != std::string::npos) {
      throws_at_.clear();
      throw std::runtime_error("no more paper");
    }
    reported_ += text + "\n";
  }

  std::mutex mutex_;
  std::string reported_, throws_at_;

 protected:
  Shared<RunBoard> board_;
  Shared<WatchdogMailbox> mailbox_;
  std::unique_ptr<SupervisedProcess> process_;
};

TEST_F(SupervisedProcessTest, AStoppedProcessIsReportedEndedAndRestarted) {
  Start();
  const int pid = process_->pid();
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  EXPECT_TRUE(Reports("The child does not respond: nothing continues."));
  EXPECT_TRUE(Reports(
      "The child did not respond and was ended; nothing continues. It is being restarted."));
  ASSERT_TRUE(IsThereAgain(pid));
  const std::uint32_t beats = mailbox_->beats;
  EXPECT_TRUE(Becomes([&] { return mailbox_->beats - beats > 10; }));
}

TEST_F(SupervisedProcessTest, AProcessThatEndsIsStartedAgain) {
  Start(false);
  const int pid = process_->pid();
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  EXPECT_TRUE(Reports("The child has ended (signal 9); nothing continues. It is being restarted."));
  EXPECT_TRUE(IsThereAgain(pid));
}

// If no process can be started for a while, the supervisor must try again until it succeeds.
TEST_F(SupervisedProcessTest, AStartThatFailsIsTriedAgain) {
  Start();
  const int pid = process_->pid();
  rlimit files{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &files), 0);
  const rlimit none = {3, files.rlim_max};  // no other descriptor can be opened
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  const bool reported = Reports("The child's process could not be started");
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &files), 0);
  EXPECT_TRUE(reported);
  EXPECT_TRUE(IsThereAgain(pid));
}

// Whatever error occurs, the supervising thread must continue to supervise the process.
TEST_F(SupervisedProcessTest, AnExceptionInTheSupervisorIsReportedAndItContinues) {
  Start(false);
  ThrowAt("It is there.");
  process_->Ask({{"are", "you there?"}});
  EXPECT_TRUE(Reports("The child: no more paper. Supervision continues."));
  const int pid = process_->pid();
  ThrowAt("has ended");
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  EXPECT_TRUE(IsThereAgain(pid));
}

}  // namespace

int SupervisedChildMain() { return ChildMain("test", Serve); }

}  // namespace predictor
