// A ROS-TCP server for Unity's ROS-TCP-Connector 0.7.0, which needs no ROS. The clients of this
// server may read data and may stop the run.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "ros_tcp/seats.h"
#include "ros_tcp/topics.h"

namespace predictor::ros_tcp {

struct RosTcpOptions {
  std::uint16_t port = 10000;  // 0: any free port
  // The networks from which clients may connect, such as 192.0.2.0/24, with a prefix of at least 8
  // bits. Loopback is always allowed.
  std::vector<std::string> allow;
  RosDialect dialect = RosDialect::kRos1;
  double rate = 60;  // maximum [Hz]; the connector's queue is unbounded
  Seats seats;
  // The connector sends a keep-alive after one second without another message. A client that is
  // silent for longer than this time is considered disconnected and loses its seat.
  std::chrono::milliseconds silence{10'000};
};

class RosTcpServer {
 public:
  // Opens the port. The port is open on all addresses of the machine only if networks are allowed.
  // All arguments are borrowed. Throws InputError if the port is not available or a network is
  // invalid.
  RosTcpServer(const RosTcpOptions& options, const RosTopics* topics, const RunBoard* board,
               StopMailbox* mailbox);
  ~RosTcpServer();
  std::uint16_t port() const;
  // Serves in this thread until Stop, which any thread may call, or until the other end of the
  // descriptor `lifeline` (-1 for none) is closed.
  void Run(int lifeline = -1);
  void Stop();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor::ros_tcp
