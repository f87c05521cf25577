#include "devices/device.h"

#include "core/error.h"
#include "devices/simulated/simulated_device.h"

namespace predictor {
namespace {

// The person at a simulated rig, as the scenario names it.
std::unique_ptr<Operator> MakePerson(const Scenario& scenario) {
  if (scenario.operator_.type == "virtual" || scenario.operator_.type == "browser")
    return MakeOperator(scenario, HandInertia::kInWrench);
  throw InputError("operator.type", "A simulated rig has no operator of type \"" +
                                        scenario.operator_.type +
                                        "\". Known types: virtual, browser.");
}

}  // namespace

std::unique_ptr<Device> MakeDevice(const Scenario& scenario,
                                   const std::array<JointVector, kHands>& start) {
  if (scenario.device.type == "simulated") {
    return std::make_unique<SimulatedDevice>(scenario, start, MakePerson(scenario));
  }
  throw InputError("device.type", "There is no device of type \"" + scenario.device.type +
                                      "\". Known types: simulated.");
}

}  // namespace predictor
