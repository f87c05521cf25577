// Tests the server's process: its rights, and what happens when it dies.
#include "support/process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <mutex>

#include "core/error.h"
#include "ros_tcp/ros_tcp_process.h"
#include "ros_tcp/unity.h"
#include "scenario/scenario_io.h"

namespace predictor::ros_tcp {
namespace {

using test::Becomes;
using test::StatusOf;

class RosTcpProcessTest : public testing::Test {
 protected:
  RosTcpProcessTest()
      : scenario_(LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml")) {
    options_.port = 0;
  }
  void Start() {
    server_ = std::make_unique<RosTcpProcess>(
        options_, scenario_, std::vector<std::string>{"a", "b"}, Vector3(0.5, 0, 0.3), board_,
        mailbox_, [this](const std::string& text) {
          const std::lock_guard lock(mutex_);
          reported_ += text + "\n";
        });
  }
  bool Reports(const std::string& text) {
    return Becomes([&] {
      const std::lock_guard lock(mutex_);
      return reported_.find(text) != std::string::npos;
    });
  }

  Scenario scenario_;
  RosTcpOptions options_;
  Shared<RunBoard> board_;
  Shared<StopMailbox> mailbox_;
  std::mutex mutex_;
  std::string reported_;
  std::unique_ptr<RosTcpProcess> server_;
};

TEST_F(RosTcpProcessTest, ServesTheRunAndCarriesAStop) {
  Start();
  TickRecord record{};
  record.tick = 1;
  record.cobot_dof = 2;
  record.object.pose.q = {1, 0, 0, 0};
  board_->records.Publish(record);
  Unity unity(server_->port());
  EXPECT_EQ(unity.Receive().destination, "__handshake");
  unity.Send("__subscribe", {{"topic", "/predictor/joint_states"}});
  board_->records.Publish(record);
  const RosFrame state = unity.Receive();
  EXPECT_EQ(state.destination, "/predictor/joint_states");
  EXPECT_NE(state.payload.find("\1\0\0\0a"), std::string::npos);
  unity.Raw(Encode("/predictor/stop", std::string(1, '\1')));
  EXPECT_TRUE(Becomes([&] { return mailbox_->stops.load() == 1; }));
}

TEST_F(RosTcpProcessTest, HasNoRights) {
  Start();
  const int pid = server_->pid();
  EXPECT_EQ(StatusOf(pid, "NoNewPrivs"), "1");
  if (geteuid() == 0) {
    EXPECT_EQ(StatusOf(pid, "Uid"), "65534\t65534\t65534\t65534");
    EXPECT_EQ(StatusOf(pid, "CapEff"), "0000000000000000");
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (!StatusOf(getpid(), "Seccomp").empty()) {
    EXPECT_EQ(StatusOf(pid, "Seccomp"), "2");
  }
#endif
  // The test checks that the process has only its own descriptors and that the records are
  // read-only.
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  int shared = 0;
  for (std::string line; std::getline(maps, line);) {
    if (line.find("memfd:predictor") == std::string::npos) continue;
    ++shared;
    const std::string range = line.substr(0, line.find(' '));
    const std::size_t bytes = std::stoull(range.substr(range.find('-') + 1), nullptr, 16) -
                              std::stoull(range, nullptr, 16);
    // The only memory that the process may write to holds the count of stops, but no input, hand or
    // lease.
    if (bytes >= sizeof(RunBoard))
      EXPECT_NE(line.find(" r--s "), std::string::npos) << line;
    else
      EXPECT_LE(bytes, 4096u) << line;
  }
  if (geteuid() == 0) {
    EXPECT_EQ(shared, 2);
  }
}

TEST_F(RosTcpProcessTest, ItsDeathIsReportedAndItRestartsOnTheSamePort) {
  Start();
  const int pid = server_->pid();
  const std::uint16_t port = server_->port();
  {
    Unity unity(port);
    EXPECT_EQ(unity.Receive().destination, "__handshake");
    ASSERT_EQ(kill(pid, SIGKILL), 0);
    EXPECT_EQ(unity.Receive().destination, "");
  }
  EXPECT_TRUE(Reports("The ROS-TCP server has ended (signal 9); the run continues."));
  ASSERT_TRUE(Becomes([&] { return server_->pid() != 0 && server_->pid() != pid; }));
  EXPECT_EQ(server_->port(), port);
  Unity again(port);
  EXPECT_EQ(again.Receive().destination, "__handshake");
}

TEST_F(RosTcpProcessTest, EndsWithTheRunAndReportsWhyItCannotStart) {
  Start();
  const int pid = server_->pid();
  RosTcpOptions same;
  same.port = server_->port();
  EXPECT_THROW(RosTcpProcess(same, scenario_, {}, Vector3::Zero(), board_, mailbox_,
                             [](const std::string&) {}),
               InputError);
  server_.reset();
  EXPECT_NE(kill(pid, 0), 0);
}

}  // namespace
}  // namespace predictor::ros_tcp
