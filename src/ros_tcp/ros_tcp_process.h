// The ROS-TCP server as a process of its own beside the run: that it dies moves nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "ros_tcp/ros_tcp_server.h"
#include "scenario/scenario.h"

namespace predictor {

// The subcommand by which this program becomes it, for RosTcpProcess alone.
inline constexpr const char* kRosTcpSubcommand = "ros-tcp-process";
int RosTcpMain();

class RosTcpProcess {
 public:
  // What a person is to be told; called in a thread of its own.
  using Tell = std::function<void(const std::string& text)>;

  // Starts it, with the rights of the viewer's process, and waits until it serves; if it dies, that
  // is told and it is started again on the same port. joints, object_start: as for RosTopics. The
  // descriptors of `board` and `mailbox` are borrowed. Throws InputError with what the server says,
  // std::runtime_error if there can be no process.
  RosTcpProcess(const RosTcpOptions& options, const Scenario& scenario,
                const std::vector<std::string>& joints, const Vector3& object_start,
                const Shared<RunBoard>& board, const Shared<StopMailbox>& mailbox, Tell tell);
  ~RosTcpProcess();
  std::uint16_t port() const;
  int pid() const;  // 0 while there is none

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
