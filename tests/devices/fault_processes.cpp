#include "devices/fault_processes.h"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "core/format.h"
#include "devices/fault_bring.h"
#include "devices/stop_channel.h"
#include "watchdog/watchdog.h"

namespace predictor {
namespace {

using enum Carrier;
using enum Expect;

constexpr double kSlow = 5e-6;  // distance in a millisecond at 5 mm/s [m]

// Lets time pass for the devices without our process.
void WithoutUs(Bench& bench, FaultOutcome* o, int bound, const std::function<void()>& each) {
  const auto handles = [&](std::size_t i) { return bench.rig().rig().true_handles()[i].X_W; };
  const std::array<Pose, kHands> begin = {handles(0), handles(1)};
  std::array<Pose, kHands> last = begin;
  std::array<double, kHands> commanded{}, way{};
  std::array<int, kHands> braked = {-1, -1};
  for (std::size_t i = 0; i < kHands; ++i)
    commanded[i] = bench.rig().commanded(static_cast<int>(i)).norm();
  for (int k = 1; k <= 600; ++k) {
    if (each) each();
    bench.Hang(0.001);
    for (std::size_t i = 0; i < kHands; ++i) {
      const double now = bench.rig().commanded(static_cast<int>(i)).norm();
      if (braked[i] < 0 && now < 0.97 * commanded[i]) braked[i] = k;
      commanded[i] = std::max(commanded[i], now);
      const double step = (handles(i).p - last[i].p).norm();
      way[i] += step;
      if (step > kSlow) o->time = 0.001 * k;
      last[i] = handles(i);
    }
  }
  o->ticks = std::max(braked[0], braked[1]);
  o->distance = std::max(way[0], way[1]);
  const Pose before = begin[0].Inverse() * begin[1], after = last[0].Inverse() * last[1];
  o->drift = (before.p - after.p).norm();
  o->turn = RotationError(before.q, after.q).norm();
  o->Require(braked[0] > 0 && braked[1] > 0, "an arm does not brake");
  o->Require(o->ticks <= bound, Formatted("brakes after %d ms", o->ticks));
  o->Require(o->time < 0.25, Formatted("rests after %.0f ms", 1e3 * o->time));
  o->Require(o->distance < 0.0134 + 0.25 * 0.060,
             Formatted("continues for %.1f mm", 1e3 * o->distance));
}

void ProcessDies(Bench& bench, int, FaultOutcome* o) {
  WithoutUs(bench, o, 23, nullptr);
  o->SetMessage("(No process is left to report it; see the robot's own panel.)");
}

// The watchdog has channels to URs. A Franka accepts only one client, so the watchdog cannot
// connect to it, and only the Franka's own time-out stops it.
struct Guarded {
  std::vector<std::unique_ptr<StopChannel>> channels;
  watchdog::Watchdog watchdog;
};

// Returns the work that the watchdog does in each later millisecond.
std::function<void()> WatchdogOf(Bench& bench) {
  const auto guarded = std::make_shared<Guarded>();
  for (int hand = 0; hand < kHands; ++hand)
    if (bench.arm(hand).tcp_ports().size() > 1)
      guarded->channels.push_back(
          OpenStopChannel({ArmMake::kUr, Bench::HostOf(hand)}, &bench.network()));
  const auto look = [guarded, &bench] {
    if (!guarded->watchdog.Look(bench.record().tick, bench.emulator().state(), bench.now())) return;
    for (const auto& channel : guarded->channels) channel->Stop();
  };
  look();
  return look;
}

void LoopHangs(Bench& bench, int, FaultOutcome* o) {
  bool all = true;
  for (int hand = 0; hand < kHands; ++hand) all = all && bench.arm(hand).tcp_ports().size() > 1;
  // The watchdog's time-out is 10 ms, it checks every millisecond, and the controller needs two
  // cycles.
  WithoutUs(bench, o, all ? 14 : 23, WatchdogOf(bench));
  o->SetMessage("The control loop hung, and the watchdog stopped the arms.");
}

void EndIsAskedFor(Bench& bench, int, FaultOutcome* o) {
  const std::uint64_t tick = bench.record().tick;
  bench.emulator().RequestEnd();
  Take(bench.AwaitStop(tick, 2), o);
  o->Require(o->end == RunState::kHeld && o->cause == StopCause::kNone,
             std::string("ends ") + Name(o->end) + ", " + Name(o->cause));
  o->Require(o->ticks == 1, Formatted("detected after %d ticks", o->ticks));
  JudgeRest(bench, o);
}

}  // namespace

std::vector<Fault> FaultsOfProcesses() {
  std::vector<Fault> all;
  const auto add = [&](int number, const char* name, Expect expect, int bound, auto upon) {
    Fault fault{number, name, kLoop, expect, bound, nullptr, false};
    fault.upon = upon;
    all.push_back(fault);
  };
  add(16, "our process dies in motion", kArmsThemselves, 23, ProcessDies);
  add(31, "the loop hangs", kArmsThemselves, 23, LoopHangs);
  add(50, "the program is asked to end", kHold, 1, EndIsAskedFor);
  FindFault(&all, 16, "")->gone = [](Bench&) { return std::function<void()>(); };
  FindFault(&all, 31, "")->gone = WatchdogOf;
  return all;
}

}  // namespace predictor
