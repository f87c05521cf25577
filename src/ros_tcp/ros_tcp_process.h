// Runs the ROS-TCP server as a separate process. If the ROS-TCP process dies, the run continues
// unaffected.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "process/supervised_process.h"
#include "ros_tcp/ros_tcp_server.h"
#include "scenario/scenario.h"

namespace predictor::ros_tcp {

// The internal subcommand that turns this program into the server. Only RosTcpProcess uses it.
inline constexpr const char* kRosTcpSubcommand = "ros-tcp-process";
int RosTcpMain();

class RosTcpProcess {
 public:
  // Shows a message to the user. A separate thread calls this function.
  using Notify = std::function<void(const std::string& text)>;

  // Starts the server with the same privileges as the viewer's process and waits until it accepts
  // clients. If the server dies, a message reports this and the server restarts on the same port.
  // `joints` and `object_start` have the same meaning as for RosTopics. The descriptors of `board`
  // and `mailbox` are borrowed. Throws InputError with the server's error message, or
  // std::runtime_error if no process can be started.
  RosTcpProcess(const RosTcpOptions& options, const Scenario& scenario,
                const std::vector<std::string>& joints, const Vector3& object_start,
                const Shared<RunBoard>& board, const Shared<StopMailbox>& mailbox, Notify notify);
  std::uint16_t port() const { return process_.port(); }
  int pid() const { return process_.pid(); }  // 0 while no process is running

 private:
  SupervisedProcess process_;
};

}  // namespace predictor::ros_tcp
