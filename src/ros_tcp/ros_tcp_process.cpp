#include "ros_tcp/ros_tcp_process.h"

#include <stdexcept>
#include <utility>

#include "process/child.h"
#include "process/supervised_process.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

Json ToJson(const RosTcpOptions& o, const Scenario& scenario,
            const std::vector<std::string>& joints, const Vector3& p) {
  return {{"scenario", SaveScenario(scenario)},
          {"file", scenario.file.filename().string()},
          {"folder", std::filesystem::absolute(scenario.file).parent_path().string()},
          {"joints", joints},
          {"object_start", {p.x(), p.y(), p.z()}},
          {"port", o.port},
          {"allow", o.allow},
          {"ros2", o.dialect == RosDialect::kRos2},
          {"rate", o.rate},
          {"most_clients", o.most_clients},
          {"silence_ms", o.silence.count()}};
}

RosTcpOptions OptionsOf(const Json& start) {
  RosTcpOptions options;
  options.port = start["port"];
  options.allow = start["allow"].get<std::vector<std::string>>();
  options.dialect = start["ros2"] ? RosDialect::kRos2 : RosDialect::kRos1;
  options.rate = start["rate"];
  options.most_clients = start["most_clients"];
  options.silence = std::chrono::milliseconds(start["silence_ms"].get<std::int64_t>());
  return options;
}

void Serve(const Json& start) {
  const Shared<RunBoard> board(kBoardDescriptor, false);
  Shared<RunMailbox> mailbox(kMailboxDescriptor, true);
  if ((*board).magic != RunBoard::kMagic || (*board).bytes != sizeof(RunBoard))
    throw std::runtime_error("The shared memory is not that of this version's run.");
  const Scenario scenario =
      ParseScenario(start["scenario"], start["file"], start["folder"].get<std::string>());
  const Json& p = start["object_start"];
  const RosTopics topics(scenario, start["joints"],
                         Vector3(p[0].get<double>(), p[1].get<double>(), p[2].get<double>()));
  RosTcpServer server(OptionsOf(start), &topics, &*board, &*mailbox);
  const std::string missing = GiveUpRights(start["parent"]);
  if (!missing.empty())
    SendLine(kControlDescriptor,
             {{"say", "The ROS-TCP server keeps rights that it does not need: this system lacks " +
                          missing + "."}},
             false);
  SendLine(kControlDescriptor, {{"ready", Name(OptionsOf(start).dialect)}, {"port", server.port()}},
           false);
  server.Run(kControlDescriptor);
}

}  // namespace

struct RosTcpProcess::Impl {
  SupervisedProcess process;
};

RosTcpProcess::RosTcpProcess(const RosTcpOptions& options, const Scenario& scenario,
                             const std::vector<std::string>& joints, const Vector3& object_start,
                             const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox,
                             Tell tell) {
  ChildSetup setup{"The ROS-TCP server",
                   kRosTcpSubcommand,
                   ToJson(options, scenario, joints, object_start),
                   {board.descriptor(), mailbox.descriptor()},
                   std::move(tell),
                   [](const Json&) {}};
  impl_ = std::unique_ptr<Impl>(new Impl{SupervisedProcess(std::move(setup))});
}

RosTcpProcess::~RosTcpProcess() = default;
std::uint16_t RosTcpProcess::port() const { return impl_->process.port(); }
int RosTcpProcess::pid() const { return impl_->process.pid(); }

int RosTcpMain() { return ChildMain("ros-tcp", Serve); }

}  // namespace predictor
