#include <cstdio>

#include "commands.h"
#include "commissioning/probe.h"
#include "devices/connect.h"
#include "scenario/machine.h"

namespace predictor {

int DevicesCommand(const DevicesOptions& options) {
  const Machine machine = LoadMachine(options.machine);
  const std::unique_ptr<Network> network = SocketNetwork();
  const auto arm = [](const MachineArm& side, Network* by) {
    return ConnectArm(side, ArmUse::kListen, by);
  };
  ProbeOptions how;
  how.duration = options.duration;
  const std::vector<Probed> probed =
      ProbeMachine(machine, {arm, ConnectSensor}, network.get(), how);
  WriteOut(ProbeText(probed));
  if (!AllAnswer(probed)) return kDeviceFailure;
  return AllMatch(probed) ? kFinished : kBadInput;
}

}  // namespace predictor
