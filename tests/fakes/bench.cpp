#include "fakes/bench.h"

#include <algorithm>
#include <stdexcept>

#include "devices/connect.h"
#include "fakes/kinds.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

constexpr int kKeyRepeat = 30;  // of a terminal [ms]

ArmMake MakeOf(const std::string& kind) {
  return kind == "franka" ? ArmMake::kFranka : ArmMake::kUr;
}

// The machine that the fakes make up, its arms as the scenario knows them.
Machine MachineOf(const Scenario& scenario, const BenchOptions& options) {
  Machine machine;
  for (int hand = 0; hand < kHands; ++hand) {
    const auto i = static_cast<std::size_t>(hand);
    if (!scenario.Has(hand) || options.arms[i].empty()) continue;
    MachineArm side;
    side.connection.make = MakeOf(options.arms[i]);
    side.connection.host = Bench::HostOf(hand);
    side.arm = scenario.arm(hand);
    side.arm.sample_rate = side.connection.make == ArmMake::kFranka ? 1000 : 500;
    side.arm.sensor.sample_rate = side.arm.sample_rate;
    if (!options.sensors[i].empty()) {
      side.sensor.make = SensorMake::kNetFt;
      side.sensor.host = Bench::SensorHostOf(hand);
      side.arm.sensor.sample_rate = 1000;
    }
    (hand == 0 ? machine.left : machine.right) = side;
  }
  return machine;
}

double Distance(const Pose& a, const Pose& b) { return (a.p - b.p).norm(); }

}  // namespace

// Passes everything on to a network that somebody else owns.
class Bench::Shared final : public Network {
 public:
  explicit Shared(Network* network) : network_(network) {}
  std::unique_ptr<Stream> Connect(const Address& peer, double timeout) override {
    return network_->Connect(peer, timeout);
  }
  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) override {
    return network_->Open(peer, port);
  }
  std::uint64_t Now() const noexcept override { return network_->Now(); }
  void Wait(double time) override { network_->Wait(time); }

 private:
  Network* network_;
};

Bench::Bench(const BenchOptions& options) {
  Scenario scenario = LoadScenario(options.scenario, {"seed=" + std::to_string(options.seed)});
  rig_ = std::make_unique<FarRig>(scenario);
  memory_ = std::make_unique<MemoryNetwork>();
  memory_->SetWorld([this] { rig_->Step(); });
  for (int hand = 0; hand < kHands; ++hand) {
    const auto i = static_cast<std::size_t>(hand);
    if (!scenario.Has(hand) || options.arms[i].empty()) continue;
    arms_[i] = MakeFake(options.arms[i], {});
    memory_->Add(HostOf(hand), arms_[i].get(), rig_->Hang(hand));
    if (options.sensors[i].empty()) continue;
    sensors_[i] = MakeFake(options.sensors[i], {});
    memory_->Add(SensorHostOf(hand), sensors_[i].get(), rig_->Hang(hand));
  }
  faulty_ = std::make_unique<FaultyNetwork>(memory_.get(), options.seed);
  const Machine machine = MachineOf(scenario, options);
  scenario.operator_.type = "person";
  ApplyMachine(machine, &scenario);
  auto device = ConnectMachine(machine, scenario, std::make_unique<Shared>(faulty_.get()));
  device_ = device.get();
  emulator_ = std::make_unique<Emulator>(scenario, std::move(device));
}

void Bench::Tick(int missed) {
  for (int i = 0; i <= missed; ++i) memory_->Pass(0.001);
  if (holds_ && ++ticks_ % kKeyRepeat == 0) {
    RunInput key;
    key.kind = InputKind::kEnable;
    key.value = 1;
    emulator_->Submit(key);
  }
  emulator_->Tick(memory_->Now(), missed);
  if (look_) look_(record());
  rig_->SetRunning(emulator_->state() == RunState::kRun);
}

void Bench::Pass(double time) {
  for (int n = static_cast<int>(1e3 * time); n > 0; --n) Tick();
}

bool Bench::Start() {
  const auto await = [this](RunState state, double patience) {
    for (int n = static_cast<int>(1e3 * patience); n > 0; --n) {
      if (emulator_->state() == state) return true;
      Tick();
    }
    return false;
  };
  if (!await(RunState::kIdle, 2)) return false;
  Hold(true);
  Pass(0.2);
  emulator_->Request(RunEvent::kAlignRequested);
  if (!await(RunState::kArmed, 20)) return false;
  emulator_->Request(RunEvent::kStartRequested);
  return await(RunState::kRun, 1);
}

BenchStop Bench::AwaitStop(std::uint64_t fault, double patience) {
  BenchStop stop;
  const auto handles = [this] {
    return std::array<Pose, kHands>{rig_->rig().true_handles()[0].X_W,
                                    rig_->rig().true_handles()[1].X_W};
  };
  std::array<Pose, kHands> begin{}, last{};
  std::array<double, kHands> way{};
  double time = 0;
  for (int n = static_cast<int>(1e3 * patience); n > 0; --n) {
    // What was done to it may have been seen already.
    if (n < static_cast<int>(1e3 * patience)) Tick();
    const RunState state = emulator_->state();
    const bool stopping =
        state == RunState::kStopping || state == RunState::kHeld || state == RunState::kUnpowered;
    if (!stopping) continue;
    if (stop.ticks < 0) {
      stop.ticks = static_cast<int>(record().tick - fault);
      begin = last = handles();
    }
    time += 0.001;
    const auto now = handles();
    for (std::size_t i = 0; i < kHands; ++i) {
      const double step = Distance(now[i], last[i]);
      way[i] += step;
      if (step > 5e-6) stop.time = time;  // 5 mm/s
    }
    last = now;
    if (state != RunState::kStopping) break;
  }
  stop.cause = record().cause;
  stop.end = emulator_->state();
  stop.distance = std::max(way[0], way[1]);
  const Pose before = begin[0].Inverse() * begin[1], after = last[0].Inverse() * last[1];
  stop.drift = Distance(before, after);
  stop.turn = RotationError(before.q, after.q).norm();
  return stop;
}

}  // namespace predictor
