// A ROS-TCP server with a made-up run, and a socket that behaves like Unity's.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ros_tcp/framing.h"
#include "ros_tcp/ros_tcp_server.h"

namespace predictor::ros_tcp {

using Json = nlohmann::ordered_json;

class Unity {
 public:
  explicit Unity(std::uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd_, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    timeval patience{20, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~Unity() { close(fd_); }
  // Sends the bytes and ignores errors, because the server may have closed the connection.
  void Raw(const std::string& bytes) const {
    (void)!send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void KeepAlive() const { Raw(std::string(8, '\0')); }
  void Send(const std::string& destination, const Json& json) const {
    Raw(Encode(destination, json.dump()));
  }
  // Returns the next frame, or an empty one if the server has closed the connection.
  RosFrame Receive() {
    for (;;) {
      if (auto frame = reader_.Next()) return *frame;
      char bytes[4096];
      const ssize_t n = read(fd_, bytes, sizeof bytes);
      if (n <= 0) return {};
      reader_.Feed({bytes, static_cast<std::size_t>(n)});
    }
  }

 private:
  int fd_;
  FrameReader reader_;
};

class RosTcp : public testing::TestWithParam<RosDialect> {
 protected:
  RosTcp() {
    scenario_.left_handle = scenario_.right_handle = HandleSpec{};
    scenario_.guidance.type = "circle";
    topics_.emplace(scenario_, std::vector<std::string>{"a", "b"}, Vector3(0.5, 0, 0.3));
    RosTcpOptions options;
    options.port = 0;
    options.dialect = GetParam();
    options.seats = {3, 3};
    options.silence = kSilence;
    server_.emplace(options, &*topics_, &*board_, &*mailbox_);
    serves_ = std::thread([this] { server_->Run(); });
    writes_ = std::thread([this] { WriteRecords(); });
  }
  ~RosTcp() override {
    done_ = true;
    writes_.join();
    server_->Stop();
    serves_.join();
  }

  void WriteRecords() {
    TickRecord r{};
    r.cobot_dof = 2;
    r.parameters = {1, 1, 1, 30, 5};
    r.state = RunState::kRun;
    r.object.pose.q = {1, 0, 0, 0};
    for (HandRecord& hand : r.hands) {
      hand.present = 1;
      hand.real.pose.q = hand.virtual_.pose.q = {1, 0, 0, 0};
      hand.wrench = {0, 0, 20, 0, 0, 1};
    }
    while (!done_) {
      ++r.tick;
      r.cobot_q = {0.5, -0.25};
      board_->records.Publish(r);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  static constexpr std::chrono::milliseconds kSilence{2000};

  Scenario scenario_;
  Shared<RunBoard> board_;
  Shared<StopMailbox> mailbox_;
  std::optional<RosTopics> topics_;
  std::optional<RosTcpServer> server_;
  std::atomic<bool> done_{false};
  std::thread serves_, writes_;
};

}  // namespace predictor::ros_tcp
