#include "devices/connect.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devices/franka/franka_arm.h"
#include "devices/net_ft/net_ft.h"
#include "devices/net_ft/rdt.h"
#include "devices/ur/ur_arm.h"

namespace predictor {
namespace {

// Checks that the connected arm is the arm in the machine file, because its rate determines how
// ages are judged.
void CheckFacts(const DeviceFacts& facts, const MachineArm& side) {
  if (std::abs(facts.rate - side.arm.sample_rate) > 1)
    throw DeviceError(facts.name + " sends " + std::to_string(static_cast<int>(facts.rate)) +
                      " samples per second, but the machine file says " +
                      std::to_string(static_cast<int>(side.arm.sample_rate)) +
                      " (arm.sample_rate). Correct it.");
}

void Tighten(const DeviceFacts& facts, ArmSpec* arm) {
  if (facts.acceleration.empty()) return;
  arm->velocity_limit.resize(facts.velocity.size(), HUGE_VAL);
  std::vector<double> acceleration;
  for (std::size_t i = 0; i < facts.acceleration.size(); ++i) {
    arm->velocity_limit[i] = std::min(arm->velocity_limit[i], facts.velocity[i]);
    acceleration.push_back(
        std::min(OneOrEach(arm->acceleration_limit, static_cast<int>(i)), facts.acceleration[i]));
  }
  arm->acceleration_limit = std::move(acceleration);
}

std::optional<FrankaCollision> CollisionOf(const ArmConnection& arm) {
  if (!arm.collision) return std::nullopt;
  FrankaCollision thresholds;
  thresholds.torque.fill(arm.collision->joint_torque);
  thresholds.force.head<3>().setConstant(arm.collision->force);
  thresholds.force.tail<3>().setConstant(arm.collision->torque);
  return thresholds;
}

std::unique_ptr<Arm> ConnectAny(const MachineArm& side, ArmUse use, Network* network) {
  if (side.connection.make == ArmMake::kFranka) {  // this arm moves only on request
    FrankaOptions options;
    options.host = side.connection.host;
    options.X_FS = side.arm.sensor.pose.ToPose();
    options.collision = CollisionOf(side.connection);
    options.listen = use == ArmUse::kListen;
    return ConnectFranka(options, network);
  }
  UrOptions options;
  options.host = side.connection.host;
  options.first_register = side.connection.first_register;
  options.listen = use == ArmUse::kListen;
  options.acceleration =
      *std::max_element(side.arm.acceleration_limit.begin(), side.arm.acceleration_limit.end());
  return ConnectUr(options, network);
}

std::optional<EnablingSource> SourceOf(const Machine& machine) {
  if (!machine.enabling) return std::nullopt;
  return EnablingSource{machine.enabling->arm == kHandNames[0] ? 0 : 1,
                        machine.enabling->digital_input};
}

}  // namespace

std::unique_ptr<Arm> ConnectArm(const MachineArm& side, ArmUse use, Network* network) {
  std::unique_ptr<Arm> arm = ConnectAny(side, use, network);
  if (use == ArmUse::kMove) CheckFacts(arm->facts(), side);
  return arm;
}

std::unique_ptr<WrenchSensor> ConnectSensor(const MachineArm& side, Network* network) {
  if (side.sensor.make == SensorMake::kOwn) return nullptr;
  NetFtOptions options;
  options.make = side.sensor.make == SensorMake::kNetFt ? NetFtMake::kAti : NetFtMake::kOnRobot;
  options.address = {side.sensor.host, rdt::kPort};
  options.counts_per_force = side.sensor.counts_per_force;
  options.counts_per_torque = side.sensor.counts_per_torque;
  options.rate = side.arm.sensor.sample_rate;
  return ConnectNetFt(options, network);
}

std::unique_ptr<RealDevice> ConnectMachine(const Machine& machine, Scenario* scenario,
                                           std::unique_ptr<Network> network) {
  std::array<RealSide, kHands> sides;
  for (const int hand : scenario->hands()) {
    const MachineArm& side = *machine.arm(hand);
    RealSide& made = sides[static_cast<std::size_t>(hand)];
    made.sensor = ConnectSensor(side, network.get());
    made.arm = ConnectArm(side, ArmUse::kMove, network.get());
    Tighten(made.arm->facts(), &*(hand == 0 ? scenario->device.left : scenario->device.right));
  }
  return std::make_unique<RealDevice>(std::move(network), std::move(sides), SourceOf(machine));
}

}  // namespace predictor
