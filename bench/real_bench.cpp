// Measures the time that drivers and supervisor need in a tick, with and without sockets of the
// operating system.
#include <time.h>

#include <cstdio>
#include <thread>

#include "core/real_time.h"
#include "devices/connect.h"
#include "fakes/held_system.h"
#include "recording.h"
#include "samples.h"
#include "scenario/machine.h"
#include "sections.h"

namespace predictor::bench {
namespace {

struct Rigging {
  const char* name;
  const char* scenario;
  std::array<std::string, 2> arms;
  std::array<bool, 2> net_ft;
};

const Rigging kRiggings[] = {
    {"two UR", "dual_ur5", {"ur", "ur"}, {false, false}},
    {"two UR, Net F/T", "dual_ur5", {"ur", "ur"}, {true, true}},
    {"two Franka", "box_9kg", {"franka", "franka"}, {false, false}},
    {"UR, Franka", "ur_and_panda", {"ur", "franka"}, {false, false}},
};

// The durations of the stages of the ticks in RUN.
using Stages = std::array<std::vector<double>, kStages>;

void Add(const TickRecord& record, Stages* us) {
  if (record.state != RunState::kRun) return;
  for (std::size_t k = 0; k < kStages; ++k)
    (*us)[k].push_back(static_cast<double>(record.stage_us[k]));
}

constexpr std::array kOurs = {Stage::kRead, Stage::kMonitor, Stage::kGuard, Stage::kWrite};

void Print(const char* name, const Stages& us) {
  double sum = 0;
  std::printf("%-18s", name);
  for (const Stage stage : kOurs) {
    const auto& samples = us[static_cast<std::size_t>(stage)];
    sum += Median(samples);
    std::printf(" %6.2f /%6.2f", Median(samples), Quantile(samples, 0.99));
  }
  const double tick = Median(us[static_cast<std::size_t>(Stage::kTick)]);
  std::printf(" %7.2f %7.2f %6.0f%% %8.2f\n", sum, tick, 100 * sum / tick,
              sum / Median(us[static_cast<std::size_t>(Stage::kSimulate)]));
}

void PrintHead() {
  std::printf("%-18s %14s %14s %14s %14s %7s %7s %7s %8s\n", "arms", "read us", "monitor us",
              "guard us", "write us", "sum", "tick", "share", "/ simul.");
}

Stages InMemory(const Rigging& rigging, int ticks) {
  HeldSystem system({std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + rigging.scenario + ".yaml",
                     rigging.arms, rigging.net_ft});
  Stages us;
  if (!system.Start()) return us;
  for (int k = 0; k < ticks && system.emulator().state() == RunState::kRun; ++k) {
    system.Tick();
    Add(system.emulator().record(), &us);
  }
  return us;
}

// The fake rig as a separate process that listens on addresses of this machine.
class FarEnd {
 public:
  explicit FarEnd(const Rigging& rigging)
      : pipe_(popen((std::string(PREDICTOR_FAKE_RIG) + " " + PREDICTOR_SOURCE_DIR + "/scenarios/" +
                     rigging.scenario + ".yaml left=" + rigging.arms[0] +
                     ":127.9.0.10 right=" + rigging.arms[1] + ":127.9.0.11 >/dev/null")
                        .c_str(),
                    "w")) {}
  ~FarEnd() {
    Say("quit");
    if (pipe_ != nullptr) pclose(pipe_);
  }
  FarEnd(const FarEnd&) = delete;
  FarEnd& operator=(const FarEnd&) = delete;
  void Say(const char* line) {
    if (pipe_ == nullptr) return;
    std::fprintf(pipe_, "%s\n", line);
    std::fflush(pipe_);
  }

 private:
  std::FILE* pipe_;
};

Machine MachineOf(const Rigging& rigging, const Scenario& scenario) {
  Machine machine;
  for (int hand = 0; hand < kHands; ++hand) {
    MachineArm side;
    const bool franka = rigging.arms[static_cast<std::size_t>(hand)] == "franka";
    side.connection.make = franka ? ArmMake::kFranka : ArmMake::kUr;
    side.connection.host = hand == 0 ? "127.9.0.10" : "127.9.0.11";
    side.arm = scenario.arm(hand);
    side.arm.sample_rate = side.arm.sensor.sample_rate = franka ? 1000 : 500;
    (hand == 0 ? machine.left : machine.right) = side;
  }
  return machine;
}

// The fake rig needs a moment to start.
std::unique_ptr<RealDevice> ConnectTo(const Machine& machine, Scenario* scenario) {
  for (int attempt = 0;; ++attempt) try {
      return ConnectMachine(machine, scenario, SocketNetwork());
    } catch (const DeviceError&) {
      if (attempt == 20) throw;
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
}

void WaitUntil(std::uint64_t due) {
  const timespec t{static_cast<time_t>(due / 1'000'000'000ULL),
                   static_cast<long>(due % 1'000'000'000ULL)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

std::uint64_t Now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

// Acts like an operator in the present state of the run.
void Hold(Emulator* emulator, int tick, FarEnd* far_end) {
  RunInput key;
  key.kind = InputKind::kEnable;
  key.value = 1;
  if (tick % 30 == 0) emulator->Submit(key);
  const RunState before = emulator->state();
  if (before == RunState::kIdle && tick % 50 == 0) emulator->Request(RunEvent::kAlignRequested);
  if (before == RunState::kArmed) emulator->Request(RunEvent::kStartRequested);
  if (before == RunState::kArmed) far_end->Say("run");
}

Stages OverSockets(const Rigging& rigging, int ticks) {
  Scenario scenario = LoadNamed(rigging.scenario);
  FarEnd far_end(rigging);
  const Machine machine = MachineOf(rigging, scenario);
  scenario.operator_.type = "person";
  ApplyMachine(machine, &scenario);
  Emulator emulator(scenario, ConnectTo(machine, &scenario));
  Stages us;
  const RealTimeScheduling scheduling;
  std::uint64_t due = Now();
  for (int k = 0; k < ticks + 12'000 && static_cast<int>(us[0].size()) < ticks; ++k) {
    WaitUntil(due += 1'000'000);
    Hold(&emulator, k, &far_end);
    emulator.Tick(due);
    Add(emulator.record(), &us);
    if (emulator.state() != RunState::kHeld && emulator.state() != RunState::kUnpowered) continue;
    std::printf("%-18s stopped by '%s' after %zu ticks: is this computer busy?\n", rigging.name,
                Name(emulator.record().cause), us[0].size());
    break;
  }
  return us;
}

}  // namespace

void TimeDriversAndSupervisor(bool quick) {
  const int ticks = quick ? 2000 : 10'000;
  Heading("Drivers and supervisor in the tick, in RUN; bytes pass between ticks (p50 / p99)");
  PrintHead();
  for (const Rigging& rigging : kRiggings) Print(rigging.name, InMemory(rigging, ticks));
  if (quick) return;
  Heading("The same in real time over sockets of this machine, system calls included");
  PrintHead();
  for (const Rigging& rigging : kRiggings) {
    if (rigging.net_ft[0]) continue;
    const Stages us = OverSockets(rigging, 5000);
    if (us[0].size() >= 1000) Print(rigging.name, us);
  }
}

}  // namespace predictor::bench
