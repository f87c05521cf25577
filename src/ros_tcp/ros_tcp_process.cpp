#include "ros_tcp/ros_tcp_process.h"

#include <utility>

#include "process/attached_run.h"
#include "process/child.h"

namespace predictor::ros_tcp {
namespace {

Json ToJson(const RosTcpOptions& o, const Scenario& scenario,
            const std::vector<std::string>& joints, const Vector3& p) {
  Json line = RunLine(scenario, p);
  line.update({{"joints", joints},
               {"port", o.port},
               {"allow", o.allow},
               {"ros2", o.dialect == RosDialect::kRos2},
               {"rate", o.rate},
               {"seats", o.seats.total},
               {"seats_per_address", o.seats.per_address},
               {"silence_ms", o.silence.count()}});
  return line;
}

RosTcpOptions OptionsOf(const Json& start) {
  RosTcpOptions options;
  options.port = start["port"];
  options.allow = start["allow"].get<std::vector<std::string>>();
  options.dialect = start["ros2"] ? RosDialect::kRos2 : RosDialect::kRos1;
  options.rate = start["rate"];
  options.seats = {start["seats"], start["seats_per_address"]};
  options.silence = std::chrono::milliseconds(start["silence_ms"].get<std::int64_t>());
  return options;
}

void Serve(const Json& start) {
  Preparation may;
  may.listen = true;
  Prepare(may);  // before the scenario is parsed
  AttachedRun run(start);
  const RosTopics topics(run.scenario, start["joints"], run.object_start);
  Shared<StopMailbox> mailbox(kMailboxDescriptor, true);
  RosTcpServer server(OptionsOf(start), &topics, &*run.board, &*mailbox);
  GiveUpRights(start, "The ROS-TCP server");
  SendLine(kControlDescriptor, {{"ready", Name(OptionsOf(start).dialect)}, {"port", server.port()}},
           false);
  server.Run(kControlDescriptor);
}

}  // namespace

RosTcpProcess::RosTcpProcess(const RosTcpOptions& options, const Scenario& scenario,
                             const std::vector<std::string>& joints, const Vector3& object_start,
                             const Shared<RunBoard>& board, const Shared<StopMailbox>& mailbox,
                             Notify notify)
    : process_({"The ROS-TCP server", kRosTcpSubcommand,
                ToJson(options, scenario, joints, object_start), board.descriptor(),
                mailbox.descriptor(), std::move(notify), [](const Json&) {}}) {}

int RosTcpMain() { return ChildMain("ros-tcp", Serve); }

}  // namespace predictor::ros_tcp
