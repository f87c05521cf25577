// ROS-TCP server for Unity's ROS-TCP-Connector 0.7.0, without ROS. Its clients read and may stop.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "ros_tcp/topics.h"

namespace predictor {

struct RosTcpOptions {
  std::uint16_t port = 10000;      // 0: one that is free
  std::vector<std::string> allow;  // networks as 192.0.2.0/24, beside the loopback
  RosDialect dialect = RosDialect::kRos1;
  double rate = 60;  // at most [Hz]; the connector's queue has no bound
  std::size_t most_clients = 8;
  // The connector sends a keep-alive after a second without another word: who is silent for longer
  // than this is gone, and makes room.
  std::chrono::milliseconds silence{10'000};
};

class RosTcpServer {
 public:
  // Opens the port; on every address only if networks are allowed. All are borrowed. Throws
  // InputError: the port cannot be had, a network is not one.
  RosTcpServer(const RosTcpOptions& options, const RosTopics* topics, const RunBoard* board,
               StopMailbox* mailbox);
  ~RosTcpServer();
  std::uint16_t port() const;
  // Serves in this thread until Stop, which any thread may call, or until the other end of the
  // descriptor `lifeline` (-1: none) is closed.
  void Run(int lifeline = -1);
  void Stop();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
