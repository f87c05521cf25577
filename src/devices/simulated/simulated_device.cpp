#include "devices/simulated/simulated_device.h"

#include <cstdio>
#include <utility>

namespace predictor {
namespace {

std::string Description(const Scenario& scenario) {
  const bool two = scenario.device.left && scenario.device.right;
  const std::optional<ArmSpec>& arm =
      scenario.device.left ? scenario.device.left : scenario.device.right;
  if (!arm) return "Simulated rig without arms";
  const VelocityLoopSpec loop = scenario.rig.loop.value_or(arm->loop);
  char text[160];
  std::snprintf(
      text, sizeof text,
      "Simulated rig: %s, velocity loop %.3g Hz, damping ratio %.2g, delay %.3g ms, %.0f Hz",
      two ? "two arms" : "one arm", loop.bandwidth, loop.damping_ratio,
      1e3 * (loop.delay + scenario.rig.computation_delay), scenario.rate);
  return text;
}

}  // namespace

SimulatedDevice::SimulatedDevice(const Scenario& scenario,
                                 const std::array<JointVector, kHands>& start,
                                 std::unique_ptr<Operator> person)
    : dt_(1 / scenario.rate),
      description_(Description(scenario)),
      rig_(scenario, start, std::move(person)) {}

Status SimulatedDevice::Read(DeviceSample* sample) noexcept {
  rig_.Read(sample);
  for (int i = 0; i < kHands; ++i) {
    const ArmSample& arm = sample->arms[static_cast<std::size_t>(i)];
    if (arm.present && arm.fault) return {StopCause::kDevice, static_cast<std::int8_t>(i), 0, 0};
  }
  return Status::Ok();
}

Status SimulatedDevice::Write(const DeviceCommand& command) noexcept {
  rig_.Step(command, dt_);
  return Status::Ok();
}

std::string SimulatedDevice::Describe() const { return description_; }

}  // namespace predictor
