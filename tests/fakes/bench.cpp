#include "fakes/bench.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "devices/connect.h"
#include "fakes/note_loops.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

constexpr int kKeyRepeat = 30;  // repeat interval of a terminal [ms]

ArmMake MakeOf(const std::string& kind) {
  return kind == "franka" ? ArmMake::kFranka : ArmMake::kUr;
}

// Returns the machine file for the fakes, with the arms of the scenario.
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
    // A measured delay includes the time that a command waits for the next cycle of a UR's
    // controller.
    if (side.connection.make == ArmMake::kUr) side.arm.loop.delay += 1 / side.arm.sample_rate;
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

// Returns the change of the handles' relative pose [m], [rad].
std::pair<double, double> Parted(const std::array<Pose, kHands>& then,
                                 const std::array<Pose, kHands>& now) {
  const Pose before = then[0].Inverse() * then[1], after = now[0].Inverse() * now[1];
  return {Distance(before, after), RotationError(before.q, after.q).norm()};
}

}  // namespace

// Forwards all calls to a network that someone else owns.
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
  if (options.change) options.change(&scenario);
  Scenario truth = scenario;
  if (options.truth) options.truth(&truth);
  rig_ = std::make_unique<FarRig>(truth, options.start);
  memory_ = std::make_unique<MemoryNetwork>();
  memory_->SetWorld([this] { rig_->Step(); });
  for (int hand = 0; hand < kHands; ++hand) {
    const auto i = static_cast<std::size_t>(hand);
    if (!scenario.Has(hand) || options.arms[i].empty()) continue;
    arms_[i] = MakeFake(options.arms[i], options.arm_options[i]);
    memory_->Add(HostOf(hand), arms_[i].get(), rig_->Hang(hand));
    if (options.sensors[i].empty()) continue;
    sensors_[i] = MakeFake(options.sensors[i], options.sensor_options[i]);
    memory_->Add(SensorHostOf(hand), sensors_[i].get(), rig_->Hang(hand));
  }
  faulty_ = std::make_unique<FaultyNetwork>(memory_.get(), options.seed);
  faulty_->SetHeard([this](const std::string& host, std::span<const std::byte> bytes) {
    if (!captures_ || (host != HostOf(0) && host != HostOf(1))) return;
    sent_.push_back({now(), host == HostOf(0) ? 0 : 1, Bytes(bytes.begin(), bytes.end())});
  });
  Machine machine = MachineOf(scenario, options);
  if (options.machine) options.machine(&machine);
  NoteLoops(&machine);
  scenario.operator_.type = "person";
  ApplyMachine(machine, &scenario);
  auto device = ConnectMachine(machine, &scenario, std::make_unique<Shared>(faulty_.get()));
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
  FollowStop();
  if (captures_) FollowStages();
}

void Bench::Pass(double time) {
  for (int n = static_cast<int>(1e3 * time); n > 0; --n) Tick();
}

bool Bench::Await(RunState state, double patience) {
  for (int n = static_cast<int>(1e3 * patience); n > 0; --n) {
    if (emulator_->state() == state) return true;
    Tick();
  }
  return false;
}

bool Bench::Start() {
  if (!Await(RunState::kIdle, 2)) return false;
  Hold(true);
  Pass(0.2);
  emulator_->Request(RunEvent::kAlignRequested);
  if (!Await(RunState::kArmed, 20)) return false;
  emulator_->Request(RunEvent::kStartRequested);
  return Await(RunState::kRun, 1);
}

void Bench::Forget(double time) {
  constexpr std::uint64_t kUnderWay = 100'000'000;  // longer than the lag of any arm [ns]
  const auto old = [&](std::uint64_t then) {
    return static_cast<double>(now() - then) > 1e9 * time;
  };
  // Keeps the stage that contains the start of the kept period, and the commands that the arms had
  // not yet followed when that stage began.
  while (stages_.size() > 1 && old(stages_[1].time)) stages_.erase(stages_.begin());
  const std::uint64_t begin = stages_.empty() ? now() : stages_[0].time;
  std::erase_if(sent_,
                [&](const Sent& sent) { return old(sent.time) && sent.time + kUnderWay < begin; });
}

namespace {

std::array<JointVector, kHands> JointsOf(const TickRecord& record) {
  std::array<JointVector, kHands> q;
  for (std::size_t i = 0; i < kHands; ++i)
    q[i] = Eigen::Map<const Eigen::VectorXd>(record.hands[i].q.data(), record.hands[i].arm_dof);
  return q;
}

}  // namespace

void Bench::FollowStages() {
  constexpr std::uint64_t kNowAndThen = 50'000'000;  // [ns]
  const RunState state = record().state;             // state in which the tick computed its command
  if (!stages_.empty() && stages_.back().state == state &&
      now() - stages_.back().time < kNowAndThen)
    return;
  stages_.push_back({now(), state, JointsOf(record())});
}

std::array<Pose, kHands> Bench::Handles() const {
  return {rig_->rig().true_handles()[0].X_W, rig_->rig().true_handles()[1].X_W};
}

// Records a stop from the tick of its decision on.
void Bench::FollowStop() {
  const RunState state = emulator_->state();
  const bool rests = state == RunState::kHeld || state == RunState::kUnpowered;
  if (state != RunState::kStopping && !rests) {
    stop_ = {};
    off_ = 0;
    return;
  }
  if (off_ == 0 && emulator_->level() == StopLevel::kPowerOff) off_ = record().tick;
  if (stop_.rested != 0) return;
  const auto now = Handles();
  if (stop_.decided == 0) {
    stop_.decided = this->now();
    decision_ = record().tick;
    stop_.q = JointsOf(record());
    begin_ = last_ = now;
    way_ = {};
  }
  const double time = 1e-9 * static_cast<double>(this->now() - stop_.decided);
  for (std::size_t i = 0; i < kHands; ++i) {
    const double step = Distance(now[i], last_[i]);
    way_[i] += step;
    if (step > 5e-6) stop_.time = time;  // 5 mm/s
  }
  last_ = now;
  stop_.distance = std::max(way_[0], way_[1]);
  std::tie(stop_.drift, stop_.turn) = Parted(begin_, now);
  stop_.apart = std::max(stop_.apart, stop_.drift);
  if (rests) stop_.rested = this->now();
}

BenchStop Bench::AwaitStop(std::uint64_t fault, double patience) {
  for (int n = static_cast<int>(1e3 * patience); n > 0 && stop_.rested == 0; --n) Tick();
  BenchStop stop = stop_;
  if (stop.decided != 0) stop.ticks = static_cast<int>(decision_ - fault);
  if (off_ != 0) stop.off = static_cast<int>(off_ - fault);
  stop.cause = record().cause;
  stop.end = emulator_->state();
  return stop;
}

}  // namespace predictor
