#include "devices/device.h"

#include "core/error.h"
#include "devices/simulated/simulated_device.h"

namespace predictor {
namespace {

// Makes the operator of a simulated rig, as specified by the scenario.
std::unique_ptr<Operator> MakePerson(const Scenario& scenario) {
  if (scenario.operator_.type == "virtual" || scenario.operator_.type == "browser")
    return MakeOperator(scenario, HandInertia::kInWrench);
  throw InputError("operator.type", "The simulated rig has no operator of type \"" +
                                        scenario.operator_.type +
                                        "\". Known types: virtual, browser.");
}

}  // namespace

std::unique_ptr<Device> MakeSimulatedDevice(const Scenario& scenario,
                                            const std::array<JointVector, kHands>& start) {
  if (scenario.device.type == "simulated")
    return std::make_unique<SimulatedDevice>(scenario, start, MakePerson(scenario));
  if (scenario.device.type == "real")
    throw InputError::At("device.type",
                         "device.type is real, which needs a machine file with the addresses of "
                         "the arms. Give the machine file with --machine FILE.");
  throw InputError::At("device.type", "device.type is \"" + scenario.device.type +
                                          "\"; it must be simulated or real.");
}

}  // namespace predictor
