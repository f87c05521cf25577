#include <nlohmann/json.hpp>

#include "commands.h"
#include "commissioning/probe.h"
#include "devices/connect.h"
#include "scenario/machine.h"

namespace predictor {
namespace {

nlohmann::json JsonOf(const commissioning::SampleTimes& times) {
  return {{"samples", times.samples},   {"rate_hz", times.rate},     {"lost_ratio", times.lost},
          {"period_p50_s", times.p50},  {"period_p99_s", times.p99}, {"period_max_s", times.max},
          {"age_p50_s", times.age_p50}, {"age_max_s", times.age_max}};
}

std::string JsonOf(const std::vector<commissioning::Probed>& probed) {
  nlohmann::json devices = nlohmann::json::array();
  for (const commissioning::Probed& device : probed)
    devices.push_back({{"place", device.place},
                       {"name", device.name},
                       {"answers", device.answers()},
                       {"problem", device.trouble},
                       {"mismatches", device.mismatches},
                       {"remarks", device.remarks},
                       {"samples", JsonOf(device.times)}});
  return devices.dump(2) + "\n";
}

}  // namespace

int DevicesCommand(const DevicesOptions& options) {
  options.CheckWritable();
  const Machine machine = LoadMachine(options.machine);
  const std::unique_ptr<Network> network = SocketNetwork();
  const auto arm = [](const MachineArm& side, Network* by) {
    return ConnectArm(side, ArmUse::kListen, by);
  };
  commissioning::ProbeOptions how;
  how.duration = options.duration;
  const std::vector<commissioning::Probed> probed =
      commissioning::ProbeMachine(machine, {arm, ConnectSensor}, network.get(), how);
  options.Write(commissioning::ProbeText(probed), JsonOf(probed));
  if (!commissioning::AllAnswer(probed)) return kDeviceFailure;
  return commissioning::AllMatch(probed) ? kFinished : kUnfit;
}

}  // namespace predictor
