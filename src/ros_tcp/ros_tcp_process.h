// The ROS-TCP server as a process of its own beside the run: that it dies moves nothing.
#pragma once

#include <cstdint>

#include "core/shared_run.h"
#include "ros_tcp/ros_tcp_server.h"

namespace predictor {

class RosTcpProcess {
 public:
  // Forks and waits until it serves; call before the program has threads. The child gives up root,
  // and ends with its parent. Throws InputError with what the server says, std::runtime_error if
  // there can be no process.
  RosTcpProcess(const RosTcpOptions& options, const RosTopics& topics,
                const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox);
  ~RosTcpProcess();
  RosTcpProcess(const RosTcpProcess&) = delete;
  RosTcpProcess& operator=(const RosTcpProcess&) = delete;
  std::uint16_t port() const { return port_; }
  int pid() const { return pid_; }

 private:
  int pid_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace predictor
