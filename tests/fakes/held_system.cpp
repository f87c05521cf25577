#include "fakes/held_system.h"

#include "devices/connect.h"
#include "fakes/kinds.h"
#include "fakes/note_loops.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"

namespace predictor {

MachineArm HeldSystem::Hang(const ArmSpec& arm, int hand, const HeldSystemOptions& options) {
  const auto i = static_cast<std::size_t>(hand);
  const bool franka = options.arms[i] == "franka";
  MachineArm side;
  side.connection.make = franka ? ArmMake::kFranka : ArmMake::kUr;
  side.connection.host = Host(10 + hand);
  side.arm = arm;
  side.arm.sample_rate = side.arm.sensor.sample_rate = franka ? 1000 : 500;
  arms_[i] = MakeFake(options.arms[i], {});
  memory_.Add(side.connection.host, arms_[i].get(), rig_->Hang(hand));
  if (!options.net_ft[i]) return side;
  side.sensor = {SensorMake::kNetFt, Host(20 + hand), 1e6, 1e6};
  side.arm.sensor.sample_rate = 1000;
  sensors_[i] = MakeFake("net_ft", {});
  memory_.Add(side.sensor.host, sensors_[i].get(), rig_->Hang(hand));
  return side;
}

HeldSystem::HeldSystem(const HeldSystemOptions& options) {
  Scenario scenario = LoadScenario(options.scenario);
  rig_ = std::make_unique<FarRig>(scenario);
  memory_.SetWorld([this] { rig_->Step(); });
  Machine machine;
  machine.left = Hang(scenario.arm(0), 0, options);
  machine.right = Hang(scenario.arm(1), 1, options);
  NoteLoops(&machine);
  scenario.operator_.type = "person";
  ApplyMachine(machine, &scenario);
  auto network = std::make_unique<HeldNetwork>(&faulty_);
  held_ = network.get();
  emulator_ =
      std::make_unique<Emulator>(scenario, ConnectMachine(machine, &scenario, std::move(network)));
  held_->Hold();
}

void HeldSystem::Between(int missed) {
  constexpr int kKeyRepeat = 30;  // repeat interval of a terminal [ms]
  for (int i = 0; i <= missed; ++i) {
    held_->Exchange();
    memory_.Pass(0.001);
    held_->Exchange();
  }
  rig_->SetRunning(emulator_->state() == RunState::kRun);
  if (++ticks_ % kKeyRepeat != 0) return;
  RunInput key;
  key.kind = InputKind::kEnable;
  key.value = 1;
  emulator_->Submit(key);
}

bool HeldSystem::Await(RunState state, int ticks) {
  for (; ticks > 0 && emulator_->state() != state; --ticks) Tick();
  return emulator_->state() == state;
}

bool HeldSystem::Start() {
  if (!Await(RunState::kIdle, 2000)) return false;
  for (int k = 0; k < 100; ++k) Tick();
  emulator_->Request(RunEvent::kAlignRequested);
  if (!Await(RunState::kArmed, 20'000)) return false;
  emulator_->Request(RunEvent::kStartRequested);
  return Await(RunState::kRun, 10);
}

}  // namespace predictor
